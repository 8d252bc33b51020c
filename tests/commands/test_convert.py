"""`proxnav convert` and the formats that `proxnav evaluate` takes."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

from proxnav.cli import main
from proxnav.datasets.dataset import Dataset
from proxnav.datasets.formats import WRITERS, read_labels
from proxnav.trajectories import OBSERVATION_10_100, clip_range, read_trajectory, select, walking_safety_ellipse
from proxnav.trajectories import write as flight_files

SMALL_SETS = Path(__file__).resolve().parents[1] / "datasets" / "formats" / "conftest.py"


@pytest.fixture
def dataset(tmp_path: Path) -> Path:
    spec = importlib.util.spec_from_file_location("small_sets", SMALL_SETS)
    small_sets = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(small_sets)
    return small_sets.make_dataset(tmp_path / "set", 4)


def sentence(capsys: pytest.CaptureFixture) -> str:
    error = capsys.readouterr().err
    assert error.startswith("proxnav ")
    assert error.count("\n") == 1
    return error


@pytest.mark.parametrize("format", [name for name in WRITERS if name != "spec2021"])
def test_a_data_set_evaluates_to_zero_against_itself_in_every_format(
    format: str, dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    out = tmp_path / "out"
    assert main(["convert", str(dataset), "--to", format, "--out", str(out), "--validation-share", "0"]) == 0
    assert f"4 images from proxnav to {format}" in capsys.readouterr().out
    tables = [p for p in out.rglob("*") if p.suffix == ".csv" or p.name in ("annotations.json", "poses.json")]
    source = out if format in ("proxnav", "urso") or not tables else tables[0]
    for sides in ((source, dataset), (dataset, source)):
        assert main(["evaluate", *map(str, sides), "--json"]) == 0
        content = json.loads(capsys.readouterr().out)
        assert (content["frames"], content["poses"]) == (4, 4)
        assert content["mean_e_c"] < 1e-9


def test_a_bop_model_comes_from_the_named_target(dataset: Path, tmp_path: Path) -> None:
    argv = ["convert", str(dataset), "--to", "bop", "--out", str(tmp_path / "bop"), "--target"]
    points = tmp_path / "points.json"
    points.write_text(json.dumps(read_labels(dataset).keypoints_m.tolist()))
    assert main([*argv, str(points)]) == 0
    info = json.loads((tmp_path / "bop" / "models" / "models_info.json").read_text())
    assert info["1"]["size_x"] == pytest.approx(3000.0)


def test_what_a_format_cannot_hold_is_said(dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert main(["convert", str(dataset), "--to", "bop", "--out", str(tmp_path / "bop")]) == 0
    assert "note: BOP knows no lens distortion" in capsys.readouterr().out


def test_poses_become_a_data_set_with_camera_and_target(dataset: Path, tmp_path: Path) -> None:
    assert main(["convert", str(dataset), "--to", "spec2019", "--out", str(tmp_path / "s")]) == 0
    argv = ["convert", str(tmp_path / "s" / "submission.csv"), "--to", "proxnav", "--out", str(tmp_path / "d")]
    argv += ["--camera", str(dataset / "camera.json"), "--target", str(dataset / "target.json")]
    assert main(argv) == 0
    back, original = Dataset(tmp_path / "d"), Dataset(dataset)
    for a, b in zip(back.labels, original.labels, strict=True):
        np.testing.assert_allclose(a.keypoints_px, b.keypoints_px, atol=1e-9)


def test_a_wrong_order_is_one_sentence_on_the_command_line(
    dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    content = json.loads((dataset / "annotations.json").read_text())
    for entry in content["annotations"]:
        entry["q_cam_target"] = np.roll(entry["q_cam_target"], -1).tolist()
    (dataset / "annotations.json").write_text(json.dumps(content))
    assert main(["convert", str(dataset), "--to", "speed+", "--out", str(tmp_path / "out")]) == 1
    assert "--quaternion-order xyzw" in sentence(capsys)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("extra", "found"),
    [
        (["--to", "yolo"], "yolo"),
        (["--to", "speed+", "--from", "yolo"], "yolo"),
        (["--to", "spec2021"], "--split"),
        (["--to", "speed+", "--validation-share", "2"], "validation-share"),
        (["--to", "stk"], "set"),
    ],
)
def test_wrong_requests_are_one_sentence(
    extra: list[str], found: str, dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    assert main(["convert", str(dataset), "--out", str(tmp_path / "out"), *extra]) == 1
    assert found in sentence(capsys)


def test_a_flight_goes_from_stk_to_ccsds_and_back(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    flight = clip_range(walking_safety_ellipse(OBSERVATION_10_100), 10.0, 100.0)
    flight = select(flight, np.arange(12))
    source = tmp_path / "source"
    source.mkdir()
    for craft in ("target", "chaser"):
        (source / f"{craft}.e").write_text(flight_files.stk_ephemeris(flight, craft))
        (source / f"{craft}.a").write_text(flight_files.stk_attitude(flight, craft))
    names = ("target.e", "chaser.e", "target.a", "chaser.a")
    argv = ["convert", *[str(source / name) for name in names], "--to", "ccsds", "--out", str(tmp_path / "ccsds")]
    assert main(argv) == 0
    written = sorted(path.name for path in (tmp_path / "ccsds").iterdir())
    assert written == ["chaser.aem", "chaser.oem", "target.aem", "target.oem"]
    names = ("target.oem", "chaser.oem", "target.aem", "chaser.aem")
    argv = ["convert", *[str(tmp_path / "ccsds" / n) for n in names], "--to", "stk", "--out", str(tmp_path / "stk")]
    assert main(argv) == 0
    back = read_trajectory([tmp_path / "stk" / "target.e", tmp_path / "stk" / "chaser.e"], t=flight.t)
    np.testing.assert_allclose(back.r_eci_target_m, flight.r_eci_target_m, atol=1e-6)  # m, of 7e6
    np.testing.assert_allclose(back.r_eci_chaser_m, flight.r_eci_chaser_m, atol=1e-6)
    turned = (source / "target.a").read_text().split("AttitudeTimeQuaternions")[1].split()
    again = (tmp_path / "stk" / "target.a").read_text().split("AttitudeTimeQuaternions")[1].split()
    q, p = (np.array(words[:-2], dtype=float).reshape(-1, 5)[:, 1:] for words in (turned, again))
    np.testing.assert_allclose(np.abs(np.einsum("ni,ni->n", q, p)), 1.0, atol=1e-9)


def test_a_lone_orbit_stays_alone(shared_data: Path, tmp_path: Path) -> None:
    source = shared_data / "stk" / "SatelliteTests_External_Satellite1.e"
    assert main(["convert", str(source), "--to", "ccsds", "--out", str(tmp_path / "out")]) == 0
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["target.oem"]


def test_labels_of_the_field_become_a_baseline_table(shared_data: Path, tmp_path: Path) -> None:
    speedplus = shared_data / "speedplus"
    argv = ["convert", str(speedplus / "shirt_roe1.json"), "--to", "krn", "--out", str(tmp_path / "krn")]
    argv += ["--camera", str(speedplus / "camera.json"), "--target", str(speedplus / "tangoPoints.mat")]
    assert main([*argv, "--split", "roe1/train"]) == 0
    table = tmp_path / "krn" / "roe1" / "splits_krn" / "train.csv"
    assert len(table.read_text().splitlines()) == 2371
    assert main(["evaluate", str(table), str(speedplus / "shirt_roe1.json"), "--json"]) == 0
