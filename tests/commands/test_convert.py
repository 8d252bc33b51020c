"""`proxnav convert` and the formats that `proxnav evaluate` takes."""

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from tests.datasets.formats.small_sets import make_dataset

from boxcraft import boxcraft
from proxnav.cli.main import main
from proxnav.datasets.formats import WRITERS, read_labels
from proxnav.datasets.set.dataset import Dataset
from proxnav.records import Trajectory
from proxnav.targets.target_files import save_target
from proxnav.trajectories import (
    OBSERVATION_10_100,
    ReaderConfig,
    clip_range,
    read_trajectory,
    select,
    walking_safety_ellipse,
)
from proxnav.trajectories import write as flight_files


@pytest.fixture
def dataset(tmp_path: Path) -> Path:
    return make_dataset(tmp_path / "set", 4)


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
    tables = [p for p in out.rglob("*") if p.suffix in (".csv", ".tum") or p.name in ("annotations.json", "poses.json")]
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


@pytest.fixture(scope="module")
def flight() -> Trajectory:
    whole = walking_safety_ellipse(OBSERVATION_10_100)
    return select(clip_range(whole, 10.0, 100.0), np.arange(12))


@pytest.fixture
def stk_files(flight: Trajectory, tmp_path: Path) -> list[Path]:
    """target.e, chaser.e, target.a, chaser.a"""
    (tmp_path / "source").mkdir()
    paths = [tmp_path / "source" / name for name in ("target.e", "chaser.e", "target.a", "chaser.a")]
    for path in paths:
        make = flight_files.stk_ephemeris if path.suffix == ".e" else flight_files.stk_attitude
        path.write_text(make(flight, path.stem))
    return paths


@pytest.mark.parametrize(
    ("to", "names"),
    [("ccsds", ["target.oem", "chaser.oem", "target.aem", "chaser.aem"]), ("csv", ["trajectory.csv"])],
)
def test_a_flight_goes_from_stk_and_back(
    to: str, names: list[str], flight: Trajectory, stk_files: list[Path], tmp_path: Path
) -> None:
    assert main(["convert", *map(str, stk_files), "--to", to, "--out", str(tmp_path / to)]) == 0
    assert sorted(path.name for path in (tmp_path / to).iterdir()) == sorted(names)
    files = [str(tmp_path / to / name) for name in names]
    assert main(["convert", *files, "--to", "stk", "--out", str(tmp_path / "stk")]) == 0
    paths = [tmp_path / "stk" / path.name for path in stk_files]
    back = read_trajectory(paths, ReaderConfig(q_chaser_cam=(1.0, 0.0, 0.0, 0.0)), t=flight.t)
    np.testing.assert_allclose(back.r_eci_target_m, flight.r_eci_target_m, rtol=0, atol=1e-6)  # m, of 7e6
    np.testing.assert_allclose(back.r_eci_chaser_m, flight.r_eci_chaser_m, rtol=0, atol=1e-6)
    for name in ("q_eci_target", "q_eci_cam"):
        same = np.abs(np.einsum("ni,ni->n", getattr(back, name), getattr(flight, name)))
        np.testing.assert_allclose(same, 1.0, rtol=0, atol=1e-12)


def test_files_of_an_earlier_conversion_are_not_overwritten(
    stk_files: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    argv = ["convert", str(stk_files[0]), "--to", "ccsds", "--out", str(tmp_path / "out")]
    assert main(argv) == 0
    assert main(argv) == 1
    assert "exists" in sentence(capsys)


def test_a_lone_orbit_stays_alone(shared_data: Path, tmp_path: Path) -> None:
    source = shared_data / "stk" / "SatelliteTests_External_Satellite1.e"
    assert main(["convert", str(source), "--to", "ccsds", "--out", str(tmp_path / "out")]) == 0
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["target.oem"]


def test_labels_of_the_field_become_a_baseline_table(shared_data: Path, tmp_path: Path) -> None:
    speedplus = shared_data / "speedplus"
    some = json.loads((speedplus / "shirt_roe1.json").read_text())["poses"][::20]
    (tmp_path / "roe1.json").write_text(json.dumps({"poses": some}))
    argv = ["convert", str(tmp_path / "roe1.json"), "--to", "krn", "--out", str(tmp_path / "krn")]
    argv += ["--camera", str(speedplus / "camera.json"), "--target", str(speedplus / "tangoPoints.mat")]
    assert main([*argv, "--split", "roe1/train"]) == 0
    table = tmp_path / "krn" / "roe1" / "splits_krn" / "train.csv"
    rows = table.read_text().splitlines()
    assert (len(rows), len(rows[0].split(","))) == (119, 12 + 22)
    assert main(["evaluate", str(table), str(speedplus / "shirt_roe1.json"), "--json"]) == 0


def test_bop_results_pair_with_images_by_number(dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    argv = ["convert", str(dataset), "--to", "bop-results", "--out", str(tmp_path / "r")]
    assert main(argv) == 0
    csv = tmp_path / "r" / "results.csv"
    csv.write_text("\n".join(csv.read_text().splitlines()[:3]) + "\n")
    capsys.readouterr()
    assert main(["evaluate", str(csv), str(dataset), "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert (content["frames"], content["poses"]) == (4, 2)


def test_a_bop_mesh_is_in_millimetres(dataset: Path, tmp_path: Path) -> None:
    saved = save_target(boxcraft(), tmp_path / "boxcraft")
    argv = ["convert", str(dataset), "--to", "bop", "--out", str(tmp_path / "bop"), "--target", str(saved)]
    assert main(argv) == 0
    mesh = trimesh.load_mesh(tmp_path / "bop" / "models" / "obj_000001.ply")
    np.testing.assert_allclose(mesh.extents, [3000.0, 2000.0, 1200.0])


DATA = Path(__file__).parents[1] / "data" / "trajectories"


@pytest.mark.parametrize(("to", "names"), [("stk", ("target.e", "chaser.e")), ("ccsds", ("target.oem", "chaser.oem"))])
def test_a_flight_in_a_hill_frame_becomes_two_orbits_of_the_same_distance(
    to: str, names: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    elements = "alt=500km e=0.002 i=97.4 raan=20 argp=10 nu=30"
    argv = ["convert", str(DATA / "lvlh_vbar.csv"), "--to", to, "--out", str(tmp_path / "out")]
    assert main([*argv, "--reader.target-elements", elements]) == 0
    said = capsys.readouterr()
    assert said.err.count("proxnav convert: note: ") == 1
    assert f"whose orbit is {elements}" in said.err
    assert f"30 instants from 2024-11-01T00:00:00Z in {tmp_path / 'out'}: {', '.join(names)}" in said.out
    back = read_trajectory([tmp_path / "out" / name for name in names])
    rho = np.loadtxt(DATA / "lvlh_vbar.csv", delimiter=",", skiprows=1)[:, 1:]
    np.testing.assert_allclose(back.range_m, np.linalg.norm(rho, axis=1), rtol=0, atol=1e-6)


def test_attitudes_of_aem_2_are_written_as_they_were_read(tmp_path: Path) -> None:
    files = [str(DATA / name) for name in ("ok.oem", "chaser.oem", "v2.aem")]
    assert main(["convert", *files, "--to", "ccsds", "--out", str(tmp_path / "out")]) == 0
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["chaser.oem", "target.aem", "target.oem"]
    before = read_trajectory(files)
    after = read_trajectory([tmp_path / "out" / name for name in ("target.oem", "chaser.oem", "target.aem")])
    same = np.abs(np.einsum("ni,ni->n", before.q_eci_target, after.q_eci_target))
    np.testing.assert_allclose(same, 1.0, rtol=0, atol=1e-12)
    np.testing.assert_allclose(after.r_eci_chaser_m, before.r_eci_chaser_m, rtol=0, atol=1e-5)


def test_the_former_spelling_of_the_readers_options_says_the_present_one(capsys: pytest.CaptureFixture) -> None:
    assert main(["convert", "x.csv", "--to", "stk", "--out", "out", "--flight.frame", "RIC"]) == 1
    assert "--flight is now --reader" in sentence(capsys)
