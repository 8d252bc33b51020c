import json

import numpy as np
import pytest
from scipy.io import loadmat

from proxnav.datasets.formats.speed_poses import PoseRecord, read_poses, write_poses
from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.records.estimates import Trust


def test_written_poses_read_back_equal(tmp_path, rng):
    poses = [Pose.from_wxyz("cam", "target", q, rng.normal(size=3)) for q in quaternion.random(rng, 5)]
    records = [PoseRecord(f"{i}.png", T, covariance=np.eye(6) * (i + 1)) for i, T in enumerate(poses)]
    write_poses(tmp_path / "poses.json", [*records, PoseRecord("none.png", None, "no_target")])
    read = read_poses(tmp_path / "poses.json")
    for record in records:
        again = read[record.filename]
        np.testing.assert_allclose(again.T_cam_target.matrix(), record.T_cam_target.matrix(), atol=1e-12)
        np.testing.assert_array_equal(again.covariance, record.covariance)
    assert read["none.png"].T_cam_target is None
    assert read["none.png"].status == "no_target"


@pytest.mark.parametrize("key", ["q_vbs2tango", "q_vbs2tango_true"])
@pytest.mark.parametrize("wrapped", [False, True])
def test_both_spellings_and_the_wrapper_read_alike(tmp_path, key, wrapped):
    entries = [{"filename": "a.jpg", key: [0.5, 0.5, 0.5, 0.5], "r_Vo2To_vbs_true": [1, 2, 3]}]
    (tmp_path / "p.json").write_text(json.dumps({"poses": entries} if wrapped else entries))
    T = read_poses(tmp_path / "p.json")["a.jpg"].T_cam_target
    np.testing.assert_allclose(T @ np.array([1.0, 0.0, 0.0]), [1, 3, 3], atol=1e-12)  # x to y under (1, 1, 1) turn


def _smooth_point(R, t):
    """The body point p whose path R p + t has the least acceleration, and what is left of t's own acceleration."""
    turn, drift = np.diff(R, n=2, axis=0).reshape(-1, 3), np.diff(t, n=2, axis=0).ravel()
    p = np.linalg.lstsq(turn, -drift, rcond=None)[0]
    return p, np.linalg.norm(turn @ p + drift) / np.linalg.norm(drift)


def test_shirt_labels_mean_what_speed_plus_intends_and_transposed_attitudes_do_not(shared_data):
    """X_cam = R(q) X_tango + r, q scalar first: all 11 points fall into every frame of ROE1, and the point of the body
    that moves along a smooth orbit is its centre, 0.16 m above the bottom face. Read as the transpose, none is."""
    records = list(read_poses(shared_data / "speedplus" / "shirt_roe1.json").values())
    camera = Camera.from_speed_json(shared_data / "speedplus" / "camera.json")
    points = loadmat(shared_data / "speedplus" / "tangoPoints.mat")["tango3Dpoints"].T
    R = np.array([record.T_cam_target.R for record in records])
    t = np.array([record.T_cam_target.t_m for record in records])
    assert camera.contains(camera.project(np.einsum("nij,kj->nki", R, points) + t[:, None])).all()
    centre, left = _smooth_point(R, t)
    assert left < 0.01
    np.testing.assert_allclose(centre[1:], [0.0, 0.16], atol=0.03)  # m; the x axis is the spin axis: not observable
    _, left = _smooth_point(R.transpose(0, 2, 1), t)
    assert left > 0.9


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("{", "not readable as JSON"),
        ("{}", "expected a list"),
        ("[1]", "filename"),
        ('[{"filename": "a"}]', "needs q_vbs2tango_true"),
        ('[{"filename": "a", "q_vbs2tango": [1, 1, 0, 0], "r_Vo2To_vbs_true": [0, 0, 1]}]', "unit quaternion"),
        ('[{"filename": "a", "q_vbs2tango": [1, 0, 0], "r_Vo2To_vbs_true": [0, 0, 1]}]', "4 finite numbers"),
        ('[{"filename": "a", "q_vbs2tango": [1, 0, 0, 0], "r_Vo2To_vbs_true": [0, 0, "x"]}]', "3 finite numbers"),
        (
            '[{"filename": "a", "q_vbs2tango": null, "r_Vo2To_vbs_true": null}, {"filename": "a", "q_vbs2tango": null,'
            ' "r_Vo2To_vbs_true": null}]',
            "more than once",
        ),
    ],
)
def test_malformed_files_are_refused_in_one_sentence(tmp_path, content, sentence):
    path = tmp_path / "p.json"
    path.write_text(content)
    with pytest.raises(InputError, match=sentence) as caught:
        read_poses(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_trust_is_written_and_read_back(tmp_path) -> None:
    trust = Trust("verified", 0.9, 0.01, 0.5, (0.1, 0.2, 0.9), (0.01, 0.02, 0.03), 1e-3)
    T = Pose.from_wxyz("cam", "target", [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 20.0])
    records = [PoseRecord("a.png", T, trust=trust), PoseRecord("b.png", T, trust=Trust("not_verifiable", float("nan")))]
    write_poses(tmp_path / "poses.json", records)
    back = read_poses(tmp_path / "poses.json")
    assert back["a.png"].trust == trust
    assert back["b.png"].trust is None  # no levels: nothing that a report could show
    content = json.loads((tmp_path / "poses.json").read_text())
    content[0]["trust"]["verdict"] = "maybe"
    (tmp_path / "poses.json").write_text(json.dumps(content))
    with pytest.raises(InputError, match="needs a verdict among verified"):
        read_poses(tmp_path / "poses.json")
