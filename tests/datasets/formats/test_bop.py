"""BOP sets as they are: rounded rotations, metres where millimetres are meant, folders that its tools ask for."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from boxcraft import boxcraft
from proxnav.datasets.formats import Labels, ReadOptions, WriteOptions, read_labels, write_labels
from proxnav.errors import InputError, InputNote
from proxnav.geometry import Camera, Pose, quaternion

CAMERA = Camera(64, 48, 60.0, 61.0, 32.0, 24.0)


def scene(folder: Path, R: np.ndarray, t: list[float], **extra: object) -> Path:
    """One image of one object."""
    folder.mkdir(parents=True, exist_ok=True)
    pose = {"cam_R_m2c": np.asarray(R).ravel().tolist(), "cam_t_m2c": t, "obj_id": 1}
    (folder / "scene_gt.json").write_text(json.dumps({"0": [pose]}))
    camera = {"cam_K": CAMERA.K.ravel().tolist(), "depth_scale": 1.0}
    (folder / "scene_camera.json").write_text(json.dumps({"0": camera}))
    (folder / "camera.json").write_text(json.dumps({"width": 64, "height": 48}))
    for name, content in extra.items():
        (folder / f"{name}.json").write_text(json.dumps(content))
    return folder


@pytest.mark.parametrize(("digits", "apart"), [(2, 1e-2), (3, 1e-3), (4, 1e-4)])
def test_rounded_rotations_are_taken_to_the_nearest_and_said(
    digits: int, apart: float, tmp_path: Path, rng: np.random.Generator
) -> None:
    """Those of LM-O, written with few digits, depart from orthogonal by up to 1e-2."""
    q = quaternion.random(rng, 1)[0]
    R = np.round(quaternion.to_matrix(q), digits)
    with pytest.warns(InputNote, match="departs from 1 by up to"):
        (record,) = read_labels(scene(tmp_path / "s", R, [0.0, 0.0, 5000.0])).records
    T = record.T_cam_target
    assert quaternion.angle_between(T.q_wxyz, q) < 2.0 * apart
    np.testing.assert_allclose(T.R @ T.R.T, np.eye(3), atol=1e-12)
    assert np.linalg.norm(T.R - R) <= np.linalg.norm(quaternion.to_matrix(q) - R) + 1e-12  # the nearest one


@pytest.mark.parametrize("R", [np.diag([1.0, 1.0, -1.0]), np.eye(3) * 1.1, np.zeros((3, 3)), np.ones((3, 3))])
def test_what_no_rounding_explains_is_no_rotation(R: np.ndarray, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"image 0: .*not a rotation"):
        read_labels(scene(tmp_path / "s", R, [0.0, 0.0, 5000.0]))


@pytest.mark.parametrize("t", [[0.0, 0.0, 0.6], [1.0, 2.0, 10.0], [5.0, 5.0, 100.0]])
def test_positions_in_metres_are_noticed(t: list[float], tmp_path: Path) -> None:
    with pytest.raises(InputError, match="look like metres"):
        read_labels(scene(tmp_path / "s", np.eye(3), t))


@pytest.mark.parametrize(
    ("diameter", "z", "wrong"), [(3000.0, 9000.0, False), (3.0, 9000.0, True), (3e6, 9000.0, True)]
)
def test_models_of_another_unit_than_the_boxes_are_noticed(
    diameter: float, z: float, wrong: bool, tmp_path: Path
) -> None:
    info = {"0": [{"bbox_obj": [20, 15, 16, 12]}]}  # 20 px of a 3 m diagonal at 9 m
    folder = scene(tmp_path / "test" / "000000", np.eye(3), [0.0, 0.0, 9000.0], scene_gt_info=info)
    (tmp_path / "models_eval").mkdir()
    (tmp_path / "models_eval" / "models_info.json").write_text(json.dumps({"1": {"diameter": diameter}}))
    if wrong:
        with pytest.raises(InputError, match="both be in millimetres"):
            read_labels(folder)
    else:
        assert read_labels(folder).records[0].T_cam_target.t_m[2] == pytest.approx(9.0)


def test_rounded_rotations_of_results_are_taken_as_well(tmp_path: Path) -> None:
    rows = "scene_id,im_id,obj_id,score,R,t,time\n1,3,1,0.9,0.87 -0.5 0 0.5 0.87 0 0 0 1,0 0 5000,-1\n"
    (tmp_path / "r.csv").write_text(rows)
    T = read_labels(tmp_path / "r.csv").records[0].T_cam_target
    assert isinstance(T, Pose)
    assert np.degrees(quaternion.angle_between(T.q_wxyz, quaternion.IDENTITY)) == pytest.approx(29.9, abs=0.1)


def test_models_for_scores_stand_where_the_toolkit_looks(labels: Labels, tmp_path: Path) -> None:
    out = write_labels(labels, tmp_path / "out", "bop", WriteOptions(target=boxcraft()))
    for name in ("obj_000001.ply", "models_info.json"):
        assert (out / "models_eval" / name).read_bytes() == (out / "models" / name).read_bytes()


def test_grey_images_go_into_rgb_where_that_is_asked_for(labels: Labels, tmp_path: Path) -> None:
    out = write_labels(labels, tmp_path / "rgb", "bop", WriteOptions(bop_images="rgb"))
    paths = sorted((out / "test" / "000000" / "rgb").glob("*.png"))
    assert len(paths) == len(labels)
    image = cv2.imread(str(paths[0]), cv2.IMREAD_UNCHANGED)
    original = cv2.imread(str(labels.records[0].image), cv2.IMREAD_UNCHANGED)
    assert image.shape == (48, 64, 3)
    np.testing.assert_array_equal(image, np.repeat(original[..., None], 3, axis=2))
    back = read_labels(out, options=ReadOptions())
    assert all(record.image is not None for record in back.records)
    grey = write_labels(back, tmp_path / "gray", "bop", WriteOptions(bop_images="gray"))
    again = cv2.imread(str(sorted((grey / "test" / "000000" / "gray").glob("*.png"))[0]), cv2.IMREAD_UNCHANGED)
    np.testing.assert_array_equal(again, original)
