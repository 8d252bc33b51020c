"""Scores of others: by hand, by their published definitions, and by their own code where that is installed."""

import json
from pathlib import Path

import numpy as np
import pytest

from proxnav.cli.main import main
from proxnav.datasets.formats import LabelRecord, Labels, read_labels, write_labels
from proxnav.datasets.formats.speed_poses import PoseRecord, write_poses
from proxnav.errors import InputError, InputNote
from proxnav.evaluation.object_model import ObjectModel, symmetries
from proxnav.evaluation.pairing import pair
from proxnav.evaluation.pose_bowl import pose_bowl_score
from proxnav.evaluation.recall import recalls
from proxnav.evaluation.surface_errors import surface_errors, surface_scores
from proxnav.evaluation.trajectory_errors import trajectory_errors
from proxnav.geometry import Camera, Pose, quaternion

CAMERA = Camera(640, 480, 600.0, 600.0, 320.0, 240.0)
ROD = ObjectModel.of_points(np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]))
S = np.sqrt(0.5)


def at(x: float, y: float, z: float, q: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0)) -> Pose:
    return Pose.from_wxyz("cam", "target", list(q), [x, y, z])


def frames(estimates: list[Pose | None], truth: list[Pose]) -> tuple:
    """Paired frames."""
    names = [f"{k}.png" for k in range(len(truth))]
    known = {n: PoseRecord(n, T) for n, T in zip(names, truth, strict=True)}
    found = {n: PoseRecord(n, T, "ok" if T else "no_target") for n, T in zip(names, estimates, strict=True)}
    return pair(found, known)


def test_a_shift_is_the_same_in_all_distances() -> None:
    found = surface_errors(at(0.3, 0.0, 10.4), at(0.0, 0.0, 10.0), ROD)
    assert (found.add_m, found.mssd_m) == pytest.approx((0.5, 0.5))
    assert np.isnan(found.mspd_px)


def test_a_half_turn_of_a_rod_is_an_error_to_add_and_none_to_add_s() -> None:
    """About z the ends change places: ADD (2 + 0 + 2) / 3, ADD-S 0; MSSD 2 m, MSPD 120 px, both 0 by the symmetry."""
    turned = at(0.0, 0.0, 10.0, (0.0, 0.0, 0.0, 1.0))
    plain = surface_errors(turned, at(0.0, 0.0, 10.0), ROD, CAMERA)
    assert plain.add_m == pytest.approx(4.0 / 3.0)
    assert plain.add_s_m == pytest.approx(0.0, abs=1e-12)
    assert (plain.mssd_m, plain.mspd_px) == pytest.approx((2.0, 120.0))
    half_turn = {"symmetries_discrete": [np.diag([-1.0, -1.0, 1.0, 1.0]).ravel().tolist()]}
    model = ObjectModel(ROD.points_m, 2.0, symmetries(half_turn))
    symmetric = surface_errors(turned, at(0.0, 0.0, 10.0), model, CAMERA)
    assert (symmetric.mssd_m, symmetric.mspd_px) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_a_continuous_symmetry_is_315_turns_about_its_axis() -> None:
    """The step by which a point moves is at most 0.01 of the diameter: pi / 0.01, as in the BOP challenge."""
    turns = symmetries({"symmetries_continuous": [{"axis": [0, 0, 1], "offset": [1000.0, 0.0, 0.0]}]})
    assert len(turns) == 315
    fixed = np.array([turn @ np.array([1.0, 0.0, 5.0]) for turn in turns])
    np.testing.assert_allclose(fixed, np.tile([1.0, 0.0, 5.0], (315, 1)), atol=1e-12)


def test_recalls_count_frames_without_a_pose_as_missed() -> None:
    """MSSD of 0.15 and 0.45 m of a 2 m diameter: below 9 and 6 of the limits 0.1 to 1.0 m; one frame is missing."""
    truth = [at(0.0, 0.0, 10.0)] * 3
    found = surface_scores(frames([at(0.15, 0, 10.0), at(0.45, 0, 10.0), None], truth), ROD, CAMERA)
    assert found.mean_mssd_m == pytest.approx(0.3)
    assert found.ar_mssd == pytest.approx((9 + 6) / 30)
    assert found.add_recall == pytest.approx(1 / 3)  # 0.15 m is below a tenth of 2 m
    assert found.mean_mspd_px == pytest.approx(18.0)  # 9 px and 27 px
    assert found.ar_mspd == pytest.approx((9 + 5) / 30)


def test_recall_at_5_cm_5_deg() -> None:
    turn = (float(np.cos(np.radians(2.0))), 0.0, 0.0, float(np.sin(np.radians(2.0))))  # 4 deg
    truth = [at(0.0, 0.0, 10.0)] * 4
    found = recalls(frames([at(0, 0, 10.04), at(0, 0, 10.0, turn), at(0, 0, 10.06), None], truth), ["0.1m,3deg"])
    assert found["5 cm 5 deg"] == pytest.approx(0.5)
    assert found["1 cm 1 deg"] == 0.0
    assert found["10 cm 10 deg"] == pytest.approx(0.75)
    assert found["0.1m,3deg"] == pytest.approx(0.5)
    assert found["1 % of range, 1 deg"] == pytest.approx(0.5)


@pytest.mark.parametrize("text", ["5", "5deg,1m", "1m,3", "x,ydeg", "-1m,3deg", "1m,3deg,4"])
def test_a_limit_that_is_none_is_one_sentence(text: str) -> None:
    with pytest.raises(InputError, match="expected a length and an angle"):
        recalls((), [text])


def chain(*rows: tuple[float, ...]) -> dict[tuple[str, int], Pose]:
    return {("a", k): Pose.from_wxyz("first", "cam", row[3:], row[:3]) for k, row in enumerate(rows)}


REFERENCE = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


def test_pose_bowl_errors_are_shares_of_the_motion_with_dead_zones() -> None:
    """Motion 4 m and 90 deg; estimated 0.4 m and 9 deg off: (0 + 0.1) / 2 each. The published script gives the same."""
    a, b = np.radians(45.0), np.radians(49.5)
    truth = chain(REFERENCE, (4.0, 0.0, 0.0, np.cos(a), np.sin(a), 0.0, 0.0))
    found = pose_bowl_score(chain(REFERENCE, (4.4, 0.0, 0.0, np.cos(b), np.sin(b), 0.0, 0.0)), truth)
    assert (found.mean_translation_error, found.mean_rotation_error) == pytest.approx((0.05, 0.05))
    assert found.score == pytest.approx(0.1)
    near = pose_bowl_score(chain(REFERENCE, (4.008, 0.0, 0.0, np.cos(a), np.sin(a), 0.0, 0.0)), truth)
    assert near.score == 0.0  # 0.002 of the motion
    still = chain(REFERENCE, REFERENCE)
    assert pose_bowl_score(chain(REFERENCE, (1.0, 0, 0, 1, 0, 0, 0)), still).score == pytest.approx(
        500.0
    )  # 1000 at most


def test_pose_bowl_tables_are_scored_by_the_command(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    head = "chain_id,i,x,y,z,qw,qx,qy,qz\na,0,0,0,0,1,0,0,0\n"
    (tmp_path / "truth.csv").write_text(f"{head}a,1,4,0,0,{S},{S},0,0\n")
    (tmp_path / "found.csv").write_text(f"{head}a,1,4.4,0,0,{S},{S},0,0\n")
    assert main(["evaluate", str(tmp_path / "found.csv"), str(tmp_path / "truth.csv"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["score"] == pytest.approx(0.05)
    (tmp_path / "found.csv").write_text(head)
    assert main(["evaluate", str(tmp_path / "found.csv"), str(tmp_path / "truth.csv")]) == 1
    assert "in one table alone" in capsys.readouterr().err


@pytest.fixture
def flight(rng: np.random.Generator) -> tuple[Labels, Labels]:
    """(estimates, truth) at 40 instants."""
    truth, found = [], []
    for k, q in enumerate(quaternion.random(rng, 40)):
        T = Pose.from_wxyz("cam", "target", q, [0.1 * k, -0.2, 10.0 + 0.5 * k])
        off = Pose.from_wxyz("cam", "cam", quaternion.exp(0.02 * rng.normal(size=3)), 0.05 * rng.normal(size=3))
        truth.append(LabelRecord(f"{k}.png", T, t_s=100.0 + 0.5 * k))
        found.append(LabelRecord(f"{k}.png", off @ T, t_s=100.0 + 0.5 * k + 0.001))
    return Labels(tuple(found)), Labels(tuple(truth))


def test_a_trajectory_is_the_camera_in_the_frame_of_the_target(tmp_path: Path) -> None:
    """The target 10 m ahead, turned by a quarter about z: the camera is 10 m behind it and turned back."""
    record = LabelRecord("a.png", at(1.0, 0.0, 10.0, (S, 0.0, 0.0, S)), t_s=2.5)
    out = write_labels(Labels((record,)), tmp_path / "out", "tum")
    line = (out / "trajectory.tum").read_text().splitlines()[1].split()
    np.testing.assert_allclose([float(v) for v in line], [2.5, 0.0, 1.0, -10.0, 0.0, 0.0, -S, S], atol=1e-12)


def test_trajectories_are_compared_at_equal_times(
    flight: tuple[Labels, Labels], tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    sides = [write_labels(labels, tmp_path / str(k), "tum") / "trajectory.tum" for k, labels in enumerate(flight)]
    for record, back in zip(flight[0].records, read_labels(sides[0]).records, strict=True):
        np.testing.assert_allclose(back.T_cam_target.matrix(), record.T_cam_target.matrix(), atol=1e-9)
    text = sides[0].read_text().splitlines()
    sides[0].write_text("\n".join(text[:-2]) + "\n999.0 0 0 0 0 0 0 1\n")  # one has no truth, two are missing
    assert main(["evaluate", *map(str, sides), "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert (content["frames"], content["poses"]) == (40, 38)
    assert content["scores"]["trajectory"]["ape_m"]["rmse"] > 0.0


def test_names_without_times_are_numbers_of_seconds_and_that_is_said(tmp_path: Path) -> None:
    labels = Labels((LabelRecord("img000007.png", at(0.0, 0.0, 9.0)),))
    with pytest.warns(InputNote, match="numbers in the file names are taken as seconds"):
        out = write_labels(labels, tmp_path / "out", "tum")
    assert (out / "trajectory.tum").read_text().splitlines()[1].startswith("7.000000000 ")


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("1 0 0 0 0 0 0\n", "expected 8 numbers"),
        ("1 0 0 9 0 0 0 1\n1 0 0 9 0 0 0 1\n", "not after the one before"),
        ("1 0 0 9 0 0 0 5\n", "unit quaternion"),
        ("1 0 0 x 0 0 0 1\n", "expected a number"),
    ],
)
def test_a_malformed_trajectory_is_one_sentence(text: str, found: str, tmp_path: Path) -> None:
    (tmp_path / "t.txt").write_text(text)
    with pytest.raises(InputError, match=found):
        read_labels(tmp_path / "t.txt")


@pytest.mark.filterwarnings("ignore")
def test_errors_of_trajectories_are_those_of_evo(flight: tuple[Labels, Labels], tmp_path: Path) -> None:
    """`evo` (GPL, not a dependency), without alignment, on the files that we write."""
    pytest.importorskip("evo", reason="evo is not installed")
    from evo.core import metrics, sync
    from evo.tools import file_interface

    sides = [write_labels(labels, tmp_path / str(k), "tum") / "trajectory.tum" for k, labels in enumerate(flight)]
    found, truth = (file_interface.read_tum_trajectory_file(str(path)) for path in sides)
    truth, found = sync.associate_trajectories(truth, found)
    poses = [[record.T_cam_target for record in labels.records] for labels in flight]
    ours = trajectory_errors(frames(*poses))
    assert ours is not None
    kinds = {"translation_part": ("ape_m", "rpe_m"), "rotation_angle_deg": ("ape_deg", "rpe_deg")}
    for kind, names in kinds.items():
        for metric, name in zip((metrics.APE, metrics.RPE), names, strict=True):
            theirs = metric(metrics.PoseRelation[kind])
            theirs.process_data((truth, found))
            for key, value in theirs.get_all_statistics().items():
                if key != "sse":
                    assert getattr(getattr(ours, name), key) == pytest.approx(value, abs=1e-6), (kind, name, key)


def test_the_command_prints_every_dialect(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    truth = [PoseRecord(f"{k}.png", at(0.0, 0.0, 10.0 + k)) for k in range(3)]
    found = [PoseRecord(f"{k}.png", at(0.02, 0.0, 10.0 + k)) for k in range(2)]
    write_poses(tmp_path / "truth.json", truth)
    write_poses(tmp_path / "found.json", found)
    argv = ["evaluate", str(tmp_path / "found.json"), str(tmp_path / "truth.json"), "--target", "tango"]
    assert main([*argv, "--within", "0.2m,3deg"]) == 0
    printed = capsys.readouterr().out
    for word in ("SPARK", "5 cm 5 deg", "0.2m,3deg", "ADD-S", "MSSD", "SPEC2021"):
        assert word in printed
    assert main([*argv, "--json"]) == 0
    scores = json.loads(capsys.readouterr().out)["scores"]
    assert scores["spark"] == pytest.approx(0.02)
    assert scores["recall"]["5 cm 5 deg"] == pytest.approx(2 / 3)
    assert scores["surface"]["mean_add_m"] == pytest.approx(0.02)
    assert scores["surface"]["mean_mspd_px"] is None  # no camera
    assert scores["trajectory"] is None


def test_a_bop_set_brings_its_own_object(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    from boxcraft import boxcraft
    from proxnav.datasets.formats import WriteOptions

    records = tuple(
        LabelRecord(f"img{k:03d}.png", at(0.0, 0.0, 10.0 + k), box_xyxy=np.array([230.0, 180, 410, 300]))
        for k in range(2)
    )
    labels = Labels(records, CAMERA, boxcraft().keypoints_m)
    out = write_labels(labels, tmp_path / "bop", "bop", WriteOptions(target=boxcraft()))
    results = write_labels(labels, tmp_path / "results", "bop-results") / "results.csv"
    assert main(["evaluate", str(results), str(out), "--json"]) == 0
    surface = json.loads(capsys.readouterr().out)["scores"]["surface"]
    assert surface["ar_mssd"] == surface["ar_mspd"] == surface["add_recall"] == 1.0
    assert surface["mean_mspd_px"] == pytest.approx(0.0, abs=1e-6)
