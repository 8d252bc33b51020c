"""The monitor names wrong conventions within a minute, and says nothing of honest flights."""

import json
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

from navigation.flights import CAMERA, fly, points
from proxnav.cli.main import main
from proxnav.datasets.sensor_records.record_files import write_records
from proxnav.flight.faults import with_fault
from proxnav.flight.simulate import SimulationConfig, simulate
from proxnav.flight.truth import TruthConfig, TumbleConfig
from proxnav.flight.wrong_records import Mistake, with_mistake
from proxnav.geometry import quaternion
from proxnav.geometry.camera_files import speed_json
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import setup_of
from proxnav.navigation.monitor.conventions import SIGNED_AXES, scalar_first
from proxnav.navigation.monitor.finding import Finding
from proxnav.navigation.monitor.monitor import Monitor
from proxnav.navigation.navigator import navigated, other_orbit
from proxnav.navigation.stream import monitored
from proxnav.records import SensorRecords
from proxnav.targets.loading import load_target
from proxnav.trajectories import HoldConfig, hold

HELD, FREE = NavigationConfig(), NavigationConfig(target="free")


def watched(records: SensorRecords, config: NavigationConfig = HELD) -> Monitor:
    setup = setup_of(records, points(), CAMERA, config)
    monitor = Monitor(setup, other_orbit(records))
    for reading in monitored(records, setup):
        monitor.take(reading)
    return monitor


def findings(records: SensorRecords, config: NavigationConfig = HELD) -> tuple[Finding, ...]:
    return watched(records, config).learnt.findings


@lru_cache(maxsize=1)
def tumbling() -> SensorRecords:
    """A minute and a half beside a target that nobody controls."""
    config = SimulationConfig(TruthConfig(step_s=0.5, tumble=TumbleConfig()))
    target = load_target("space-rider")
    flight = hold(HoldConfig(duration_s=90.0, step_s=10.0))
    return simulate(flight, target, CAMERA, config, np.random.default_rng(3))[1]


@pytest.mark.parametrize(
    ("mistake", "cause"),
    [
        ("baseline_negated", "the GNSS baseline is opposite to the camera's"),
        ("gyro_permuted", "a permutation or sign of axes: the camera's axes are (z, x, y) of the gyro's"),
        ("gyro_swapped", "a permutation or sign of axes: the camera's axes are (y, x, z) of the gyro's"),
        ("gyro_reversed", "a permutation or sign of axes: the camera's axes are (-x, -y, -z) of the gyro's"),
        ("gyro_relative", "relative to the orbital frame"),
        ("star_conjugated", "the quaternions of the star tracker look conjugated"),
        ("star_scalar_last", "the quaternions of the star tracker look written with the scalar last"),
        ("star_mounting_left_out", "a mounting that is left out"),
        ("poses_conjugated", "the quaternions of the poses look conjugated"),
        ("poses_inverse", "T_target_cam, the inverse"),
        ("ephemeris_in_teme", "differ by precession: ephemeris.csv looks given in TEME"),
        ("chaser_ephemeris_in_teme", "differ by precession: chaser_ephemeris.csv looks given in TEME"),
        ("ephemeris_in_gps_time", "clocks of the two ephemerides differ by 18.0 s"),
        ("antennas_of_another_craft", "check where the antennas sit"),
    ],
)
def test_a_convention_that_is_read_otherwise_is_named_within_a_minute(mistake: Mistake, cause: str) -> None:
    found = findings(with_mistake(fly(seconds=120.0)[1], mistake))
    assert [finding.t <= 60.0 for finding in found] == [True], found
    assert cause in found[0].cause


@pytest.mark.parametrize("mistake", ["baseline_negated", "gyro_permuted", "poses_conjugated", "star_conjugated"])
def test_beside_a_tumbling_target_they_are_named_too(mistake: Mistake) -> None:
    found = findings(with_mistake(tumbling(), mistake), FREE)
    assert len(found) == 1
    assert found[0].t <= 60.0


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_nothing_is_said_of_honest_flights_and_of_faults_that_the_filter_copes_with(seed: int) -> None:
    _, records = fly(seconds=120.0, seed=seed)
    monitor = watched(records)
    assert monitor.learnt.findings == ()
    assert set(monitor.learnt.compared) == {
        "GNSS and camera", "both ephemerides", "clocks of camera and star tracker", "clocks of gyro and star tracker",
        "gyro and star tracker", "poses and held attitude", "poses and keypoints",
    }  # fmt: skip
    for fault in ("wrong_frames", "gyro_step", "disorder"):
        assert findings(with_fault(records, fault, np.random.default_rng(seed))) == (), fault
    assert findings(tumbling(), FREE) == ()


def test_what_is_not_there_is_not_compared() -> None:
    _, records = fly(seconds=120.0)
    alone = replace(records, gyro=None, gnss=None, chaser_ephemeris=None, keypoints=None)
    assert watched(alone, FREE).learnt.compared == ()


@pytest.mark.parametrize(("mistake", "kind"), [("camera_clock", "camera"), ("gyro_clock", "gyro")])
def test_a_clock_that_is_half_a_second_off_is_told_from_the_cameras_own_wobble(mistake: Mistake, kind: str) -> None:
    found = findings(with_mistake(fly(seconds=240.0)[1], mistake))
    assert len(found) == 1
    assert found[0].kind.startswith(f"clock of {kind}")
    offset = float(found[0].cause.split("offset of ")[1].split(" s")[0])
    assert 0.3 < offset < 0.7


def test_ephemerides_that_are_exchanged_do_no_harm() -> None:
    """They differ by the distance of the craft, which is less than what an ephemeris may be wrong by."""
    _, records = fly(seconds=120.0)
    t = np.array([100.0])
    states = [
        navigated(r, setup_of(r, points(), CAMERA, HELD), t).states[0]
        for r in (records, with_mistake(records, "ephemerides_exchanged"))
    ]
    ours, theirs = states
    assert ours is not None
    assert theirs is not None
    assert np.linalg.norm(ours.r_ric_m - theirs.r_ric_m) < 1e-3  # m
    assert theirs.status == "tracking"


def test_the_48_signed_axes_are_all_and_scalar_first_undoes_scalar_last() -> None:
    assert len({M.tobytes() for M in SIGNED_AXES}) == 48
    np.testing.assert_array_equal(abs(np.linalg.det(SIGNED_AXES)), 1.0)
    np.testing.assert_array_equal(scalar_first(np.array([0.1, 0.2, 0.3, 0.9])), [0.9, 0.1, 0.2, 0.3])


def run_folder(folder: Path, records: SensorRecords) -> str:
    write_records(folder, records)
    (folder / "camera.json").write_text(json.dumps(speed_json(CAMERA)))
    return str(folder)


def test_a_suspect_solution_says_so_in_status_summary_and_exit_status(
    tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    records = with_mistake(fly(seconds=90.0)[1], "baseline_negated")
    assert main(["navigate", run_folder(tmp_path, records), "--step-s", "5"]) == 3
    assert "SUSPECT: from t = 44 s: the GNSS baseline is opposite to the camera's" in capsys.readouterr().out
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["verdict"] == "suspect"
    assert summary["suspect"][0]["sensors"] == "GNSS against camera"
    header, *body = (tmp_path / "solution.csv").read_text().splitlines()
    names, last = header.split(","), body[-1]
    assert names[0] == "status"
    assert names[-1] == "cause"
    assert last.startswith("suspect,")
    assert "opposite" in last
    assert body[0].startswith("tracking,")


def test_a_filter_that_never_starts_says_why(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    _, records = fly(seconds=90.0)
    assert records.poses is not None
    turn = quaternion.exp(np.array([0.4, 0.7, -0.5]))
    poses = replace(records.poses, q_cam_target=quaternion.multiply(records.poses.q_cam_target, turn))
    folder = run_folder(tmp_path, replace(records, poses=poses, keypoints=None))
    assert main(["navigate", folder, "--step-s", "5", "--smooth"]) == 3
    said = capsys.readouterr().out
    assert "the filter never started" in said
    assert "the poses show the target turned by 55 deg from the attitude that it should hold" in said
    assert (tmp_path / "solution.csv").read_text().count("\n") == 1


def test_a_filter_that_starts_again_and_again_says_so_with_each_cause(tmp_path: Path) -> None:
    _, records = fly(seconds=240.0)
    assert records.poses is not None
    jumps = 3.0 * (np.floor(records.poses.t / 40.0) % 2.0)  # m, every 40 s the camera sees the target elsewhere
    there = records.poses.t_cam_target_m + jumps[:, None] * np.array([1.0, 0.0, 0.0])
    jumping = replace(records, poses=replace(records.poses, t_cam_target_m=there), keypoints=None, gnss=None)
    assert main(["navigate", run_folder(tmp_path, jumping), "--step-s", "5"]) == 3
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert len(summary["restarts"]) >= 3
    assert all("of the last 16 frames were refused" in restart["cause"] for restart in summary["restarts"])
    assert any("started" in doubt for doubt in summary["doubts"])
