"""Sensor models have the statistics that they claim; records survive the disc, and bad ones are refused or counted."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from navigation.flights import CAMERA, SENSING, fly, points
from proxnav.benchmarks.error_memory import (
    KeypointResiduals,
    PoseResidual,
    error_memory,
    least_squares_pose,
    pose_memory,
)
from proxnav.cli.main import main
from proxnav.datasets.sensor_records.plausibility import check_together
from proxnav.datasets.sensor_records.record_files import read_records, write_records
from proxnav.errors import InputError
from proxnav.flight.attitude_motion import WobbleConfig, wobble
from proxnav.flight.sensors.gauss_markov import gauss_markov
from proxnav.flight.sensors.gnss import CARRIER_GNSS, GnssConfig, read_gnss
from proxnav.flight.sensors.inertial import AccelerometerConfig, GyroConfig, read_accelerometer, read_gyro
from proxnav.flight.sensors.star_tracker import StarTrackerConfig, read_star_tracker
from proxnav.flight.truth import Truth
from proxnav.flight.truth_files import read_truth, true_states, write_truth
from proxnav.geometry import quaternion, so3
from proxnav.geometry.camera_files import speed_json
from proxnav.geometry.celestial import EARTH_RATE
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import setup_of
from proxnav.records import Antennas, KeypointData, SensorRecords
from proxnav.records.error_model import KeypointErrorModel, PoseErrorModel


def test_gauss_markov_has_its_sigma_and_its_correlation_time(rng: np.random.Generator) -> None:
    x = gauss_markov(2.0, 60.0, 1.0, (600, 2000), rng)
    np.testing.assert_allclose(x.std(axis=1), 2.0, rtol=0.1)
    lagged = np.mean(x[:-60] * x[60:]) / np.mean(x * x)
    assert abs(lagged - np.exp(-1.0)) < 0.03


def test_wobble_keeps_its_sigma(rng: np.random.Generator) -> None:
    errors = wobble(WobbleConfig(0.3, 60.0), 0.5, 60_000, rng)
    np.testing.assert_allclose(np.rad2deg(errors.std(axis=0)), 0.3, rtol=0.15)


def test_gyro_noise_is_the_angle_random_walk(rng: np.random.Generator) -> None:
    truth, _ = fly()
    quiet = GyroConfig(turn_on_bias_deg_h=0.0, bias_instability_deg_h=0.0, scale_sigma=0.0, misalignment_sigma_rad=0.0)
    noise = read_gyro(truth, quiet, rng).rate - truth.rate_cam
    np.testing.assert_allclose(noise.std() * np.sqrt(truth.step_s), quiet.noise_rad_per_sqrt_s, rtol=0.1)


def test_integrated_true_rates_are_the_attitude() -> None:
    truth, _ = fly()
    q = truth.q_eci_cam[0]
    for rate in truth.rate_cam[1:]:
        q = quaternion.multiply(q, quaternion.exp(rate * truth.step_s))
    assert quaternion.angle_between(q, truth.q_eci_cam[-1]) < 1e-9  # rad


def test_accelerometer_feels_only_burns_and_drag(rng: np.random.Generator) -> None:
    truth, _ = fly()
    data = read_accelerometer(
        truth, AccelerometerConfig(noise_mps_per_sqrt_s=0.0, bias_sigma_mps2=0.0, scale_sigma=0.0), rng
    )
    coasting = data.thrust == 0.0
    assert np.linalg.norm(data.specific_force[coasting], axis=1).max() < 1e-5  # m/s^2
    assert coasting.mean() > 0.9


def test_gnss_error_is_noise_and_bias_and_outages_come_only_near(rng: np.random.Generator) -> None:
    truth, _ = fly(seconds=240.0)
    clear = GnssConfig(outage_share=0.0, chaser_antenna_cam_m=(0.0, 0.0, 0.0), target_antenna_target_m=(0.0, 0.0, 0.0))
    data = read_gnss(truth, clear, rng)
    k = np.round(data.t / truth.step_s).astype(int)
    error = data.position_m - (truth.r_eci_chaser_m - truth.r_eci_target_m)[k]
    assert abs(error.std() - np.hypot(clear.sigma_position_m, clear.bias_sigma_m)) < 0.1  # m
    assert len(data.t) == 241
    assert len(read_gnss(truth, replace(clear, outage_share=0.5, outage_inside_m=1e3), rng).t) < 200
    assert len(read_gnss(truth, replace(clear, outage_share=1.0, outage_inside_m=1.0), rng).t) == 241
    assert (np.diff(data.received) >= 0.0).all()
    assert ((data.received - data.t) >= clear.latency_s[0]).all()
    assert CARRIER_GNSS.sigma_position_m < clear.sigma_position_m


def test_star_tracker_is_worst_about_its_boresight(rng: np.random.Generator) -> None:
    truth, _ = fly(seconds=240.0)
    data = read_star_tracker(truth, StarTrackerConfig(), rng)
    k = np.round(data.t / truth.step_s).astype(int)
    error = quaternion.log(quaternion.multiply(quaternion.conjugate(truth.q_eci_cam[k]), data.q_eci_cam))
    np.testing.assert_allclose(np.rad2deg(error.std(axis=0)) * 3600.0, [10.0, 50.0, 10.0], rtol=0.15)


@pytest.mark.parametrize(("pose", "point", "white"), [(0.0, 0.2, 0.2), (0.4, 0.0, 1e-6), (0.45, 0.083, 0.005)])
def test_keypoint_errors_have_the_shares_and_the_memory_that_were_asked_for(
    pose: float, point: float, white: float
) -> None:
    errors = KeypointErrorModel(pose_share=pose, point_share=point, white_share=white, tau_s=20.0)
    frames = []
    for seed in range(3):
        sensing = replace(SENSING, detector=replace(SENSING.detector, errors=errors))
        truth, records = fly(seconds=240.0, sensing=sensing, seed=seed)
        assert records.keypoints is not None
        frames += [frame_errors(truth, records.keypoints, i, seed) for i in range(len(records.keypoints.t))]
    found = error_memory(frames, CAMERA.fx)
    assert abs(found["pose_share"] - pose) < 0.25
    assert abs(found["point_share"] - point) < 0.03
    assert abs(found["white_share"] - white) < 0.03
    assert 12.0 < found["tau_s"] < 32.0


@pytest.mark.parametrize(("lasting", "white"), [(0.3, 0.03), (0.1, 0.3), (1.0, 0.01)])
def test_pose_errors_have_the_shares_and_the_memory_that_were_asked_for(lasting: float, white: float) -> None:
    errors = PoseErrorModel(lasting_share=lasting, white_share=white, tau_s=20.0)
    poses = []
    for seed in range(3):
        sensing = replace(SENSING, detector=replace(SENSING.detector, pose_errors=errors))
        truth, records = fly(seconds=240.0, sensing=sensing, seed=seed)
        poses += pose_errors(truth, records, seed)
    found = pose_memory(poses, CAMERA.fx)
    assert abs(found["lasting_share"] - lasting) < 0.35 * lasting
    assert abs(found["white_share"] - white) < 0.15 * (lasting + white)
    assert 12.0 < found["tau_s"] < 32.0
    assert abs(found["correlation_with_keypoint_poses"]) < 0.3  # drawn apart


def pose_errors(truth: Truth, records: SensorRecords, seed: int) -> list[PoseResidual]:
    """Of every pose, beside the least-squares pose of its keypoints."""
    data, keypoints = records.poses, records.keypoints
    assert data is not None
    assert keypoints is not None
    found = []
    for i, t in enumerate(data.t.tolist()):
        j, A = round(t / truth.step_s), np.eye(6)
        turn = quaternion.multiply(quaternion.conjugate(truth.q_cam_target[j]), data.q_cam_target[i])
        error = np.concatenate([data.t_cam_target_m[i] - truth.t_cam_target_m[j], quaternion.log(turn)])
        A[3:, 3:] = quaternion.to_matrix(truth.q_cam_target[j]).T
        step, H = least_squares_pose(frame_errors(truth, keypoints, i, seed))
        cov = A @ data.covariance[i] @ A.T
        found.append(PoseResidual(t + 1e5 * seed, 30.0, error, cov, 2.0, A @ step, A @ np.linalg.inv(H) @ A.T))
    return found


def frame_errors(truth: Truth, data: KeypointData, i: int, seed: int) -> KeypointResiduals:
    j = round(float(data.t[i]) / truth.step_s)
    turned = points() @ quaternion.to_matrix(truth.q_cam_target[j]).T
    cam = turned + truth.t_cam_target_m[j]
    J_pi = CAMERA.projection_jacobian(cam)
    J = np.concatenate([J_pi, -J_pi @ so3.skew(turned)], axis=-1)
    error = data.pixels[i] - CAMERA.project(cam)
    return KeypointResiduals(data.t[i] + 1e5 * seed, 30.0, error, data.covariances_px2[i], J)


def test_the_same_seed_gives_the_same_records_and_a_missing_sensor_changes_no_other() -> None:
    _, first = fly(seconds=30.0)
    _, second = fly(seconds=30.0, sensing=replace(SENSING, gnss="none", gyro=None))
    assert first.keypoints is not None
    assert second.keypoints is not None
    assert np.array_equal(first.keypoints.pixels, second.keypoints.pixels, equal_nan=True)
    assert second.gnss is None


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Records of half a minute."""
    truth, records = fly(seconds=30.0)
    write_records(tmp_path, records)
    write_truth(tmp_path / "truth.csv", true_states(truth))
    return tmp_path


def test_records_come_back_as_they_were(folder: Path) -> None:
    _, records = fly(seconds=30.0)
    read = read_records(folder)
    assert read.rejected == {}
    for name in (
        "ephemeris",
        "gyro",
        "accelerometer",
        "gnss",
        "star_tracker",
        "keypoints",
        "poses",
        "chaser_ephemeris",
    ):
        ours, theirs = getattr(records, name), getattr(read.records, name)
        for field in ours.__dataclass_fields__:
            assert np.array_equal(getattr(ours, field), getattr(theirs, field), equal_nan=True), (name, field)
    assert read.records.epoch_utc == records.epoch_utc


def test_truth_comes_back_and_is_interpolated(folder: Path) -> None:
    truth, _ = fly(seconds=30.0)
    read = read_truth(folder / "truth.csv")
    np.testing.assert_array_equal(read.q_cam_target, truth.q_cam_target)
    between = read.at(np.array([0.25]))
    np.testing.assert_allclose(between.r_ric_m[0], 0.5 * (read.r_ric_m[0] + read.r_ric_m[1]))
    with pytest.raises(InputError, match="the truth covers"):
        read.at(np.array([1e4]))


def edit(path: Path, change) -> None:
    """Rewrites a csv: `change` takes and gives (header, rows of text)."""
    header, *body = path.read_text().splitlines()
    header, table = change(header.split(","), [row.split(",") for row in body])
    path.write_text("\n".join([",".join(header), *(",".join(row) for row in table)]) + "\n")


def scaled(column: str, factor: float):
    def change(header, table):
        for i in [i for i, name in enumerate(header) if name.startswith(column)]:
            for row in table:
                row[i] = repr(float(row[i]) * factor)
        return header, table

    return change


@pytest.mark.parametrize(
    ("name", "column", "factor"),
    [
        ("ephemeris", "r_eci", 1e-3), ("ephemeris", "r_eci", 1e3), ("gyro", "rate", 1e3), ("gnss", "r_eci", 1e3),
        ("gnss", "r_eci", 1e-3), ("accelerometer", "force", 1e3), ("poses", "t_cam", 1e3), ("poses", "t_cam", 1e-3),
        ("gnss", "t_s", 1e3), ("star_tracker", "q_eci", 1e3),
    ],
)  # fmt: skip
def test_units_wrong_by_a_thousand_are_one_sentence(
    name: str, column: str, factor: float, folder: Path, capsys: pytest.CaptureFixture
) -> None:
    edit(folder / f"{name}.csv", scaled(column, factor))
    assert main(["navigate", str(folder), "--camera", str(camera_file(folder))]) == 1
    error = [line for line in capsys.readouterr().err.splitlines() if not line.startswith("first use")]
    assert len(error) == 1
    assert name in error[0] or "poses" in error[0]
    assert not (folder / "solution.csv").exists()


def camera_file(folder: Path) -> Path:
    path = folder / "camera.json"
    path.write_text(json.dumps(speed_json(CAMERA)))
    return path


def test_a_missing_column_is_named(folder: Path) -> None:
    edit(folder / "gyro.csv", lambda header, table: ([h.replace("rate_y_rad_s", "wy") for h in header], table))
    with pytest.raises(InputError, match=r"gyro\.csv: column rate_y_rad_s is missing"):
        read_records(folder)


def test_antennas_come_from_the_records_or_the_options_and_are_asked_for_otherwise(folder: Path) -> None:
    about = json.loads((folder / "records.json").read_text())
    assert about["antennas"] == {"chaser_cam_m": [0.0, -0.15, -0.1], "target_target_m": [-2.0, 0.0, -1.2]}
    here = read_records(folder).records
    given = setup_of(here, points(), CAMERA, NavigationConfig()).antennas
    assert given == Antennas((0.0, -0.15, -0.1), (-2.0, 0.0, -1.2))
    by_hand = NavigationConfig(chaser_antenna_cam_m=(1.0, 0.0, 0.0), target_antenna_target_m=(0.0, 0.0, 0.0))
    assert setup_of(here, points(), CAMERA, by_hand).antennas == Antennas((1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    with pytest.raises(
        InputError, match=r"records\.json does not say where these sit: add antennas there, or give --f"
    ):
        setup_of(replace(here, antennas=None), points(), CAMERA, NavigationConfig())
    assert setup_of(replace(here, antennas=None), points(), CAMERA, NavigationConfig(gnss=False)).antennas is None
    with pytest.raises(InputError, match="two ends"):
        NavigationConfig(chaser_antenna_cam_m=(1.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"frame": "TEME"}, "must be those of J2000"), ({"antennas": {"chaser_cam_m": [0, 0, 0]}}, "antennas needs"),
        ({"antennas": {"chaser_cam_m": [0, 0], "target_target_m": [0, 0, 0]}}, "three numbers"),
    ],
)  # fmt: skip
def test_records_of_another_frame_or_with_half_an_antenna_are_one_sentence(
    change: dict, sentence: str, folder: Path
) -> None:
    path = folder / "records.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    with pytest.raises(InputError, match=sentence):
        read_records(folder)


def test_an_ephemeris_in_axes_that_turn_with_earth_or_with_velocities_of_other_axes_is_refused() -> None:
    _, records = fly(seconds=120.0)
    e = records.ephemeris
    turn = quaternion.exp(np.array([0.0, 0.0, -EARTH_RATE]) * e.t[:, None])
    fixed = quaternion.rotate(turn, e.r_eci_m)
    seen = quaternion.rotate(turn, e.v_eci_mps) - np.cross([0.0, 0.0, EARTH_RATE], fixed)
    check_together(records)
    with pytest.raises(InputError, match=r"ephemeris\.csv: its velocities change otherwise than by Earth's gravity"):
        check_together(replace(records, ephemeris=replace(e, r_eci_m=fixed, v_eci_mps=seen)))
    with pytest.raises(InputError, match=r"ephemeris\.csv: its velocities differ from the rates of its positions by 7"):
        check_together(replace(records, ephemeris=replace(e, v_eci_mps=seen)))


def test_a_missing_file_is_named(folder: Path) -> None:
    (folder / "ephemeris.csv").unlink()
    with pytest.raises(InputError, match=r"no ephemeris\.csv"):
        read_records(folder)


def test_rows_of_nan_and_words_and_wild_values_are_counted_and_left_out(folder: Path) -> None:
    def spoil(header, table):
        table[3][1] = "nan"
        table[5][1] = "three"
        table[7] = table[7][:2]
        table[9][1] = "1e6"
        return header, table

    edit(folder / "gyro.csv", spoil)
    read = read_records(folder)
    assert dict(read.rejected["gyro"]) == {"not finite": 1, "implausible": 1, "not numbers": 2}
    assert read.records.gyro is not None
    assert len(read.records.gyro.t) == 61 - 4


def test_navigate_survives_gaps_and_time_that_runs_backwards(folder: Path, capsys: pytest.CaptureFixture) -> None:
    def tear(header, table):
        del table[20:30]
        table[40], table[41] = table[41], table[40]
        return header, table

    for name in ("gyro", "gnss", "star_tracker"):
        if name == "gnss":
            continue
        edit(folder / f"{name}.csv", tear)
    assert main(["navigate", str(folder), "--camera", str(camera_file(folder)), "--step-s", "5", "--smooth"]) == 0
    said = capsys.readouterr().out
    assert "inside 3 sigma" in said
    header = (folder / "solution.csv").read_text().splitlines()[0].split(",")
    assert header[:2] == ["status", "t_s"]
    assert {"cov_0_0", "sigma_r_ric_x_m", "nees", "inside_3_sigma"} <= set(header)
    assert (folder / "smoothed.csv").is_file()


def test_simulate_writes_what_navigate_reads(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    out = str(tmp_path / "run")
    argv = ["simulate", "--out", out, "--preset", "hold-30m", "--duration-s", "20", "--truth.step-s", "0.5"]
    assert main(argv) == 0
    assert main(["navigate", out]) == 0
    assert "inside 3 sigma" in capsys.readouterr().out
