"""Errors of the camera's calibration in the filter: states that last for the whole flight."""

from dataclasses import replace

import numpy as np
import pytest
from tests.navigation.flights import CAMERA, SENSING, points, reference

from proxnav.evaluation.navigation_errors import nav_errors
from proxnav.flight.simulate import SimulationConfig, simulate
from proxnav.flight.truth import TruthConfig
from proxnav.flight.truth_files import true_states
from proxnav.geometry import Camera
from proxnav.geometry.calibration import EXACT, CalibrationSigma
from proxnav.navigation.config import SURVEYED, NavigationConfig
from proxnav.navigation.filter_setup import setup_of
from proxnav.navigation.kernels.keypoints import keypoint_model
from proxnav.navigation.layout import FRAME, E, Layout, X
from proxnav.navigation.measurements import in_target_axes, noise_of_pose
from proxnav.navigation.navigator import run_filter
from proxnav.navigation.readings import PoseFix
from proxnav.targets.loading import load_target

UNSURE = replace(CAMERA, calibration_sigma=CalibrationSigma(0.01, 5.0))
TURNING = (np.eye(3), 0.0, np.zeros(3))
"""RIC as the inertial axes, a camera that does not turn."""


def flown(seed: int, coupling: str, camera: Camera):
    """(mean squared error in units of the covariance over the last minute, last belief) of two minutes 30 m away."""
    sensing = SimulationConfig(TruthConfig(step_s=0.5), replace(SENSING, gnss="none"))
    rng = np.random.default_rng(seed)
    truth, records = simulate(reference(120.0), load_target("space-rider"), UNSURE, sensing, rng)
    config = NavigationConfig(coupling=coupling, geometry=SURVEYED)  # type: ignore[arg-type]
    setup = setup_of(records, points(), camera, config, UNSURE.calibration_sigma)
    t = np.arange(truth.t[0] + 60.0, truth.t[-1], 10.0)
    states, _, last = run_filter(records, setup, t)
    return float(np.nanmean(nav_errors(states, true_states(truth).at(t)).nees)), last


@pytest.mark.parametrize("coupling", ["loose", "tight"])
def test_covariances_stay_honest_when_the_camera_errs_by_what_is_declared(coupling: str) -> None:
    told = [flown(seed, coupling, UNSURE)[0] for seed in range(3)]
    silent = [flown(seed, coupling, CAMERA)[0] for seed in range(3)]
    assert np.mean(told) < 24.0  # 12 on average; poses of a flight err together, so three flights say little more
    assert np.mean(silent) > 2.0 * np.mean(told)


@pytest.mark.parametrize("coupling", ["loose", "tight"])
def test_what_the_distance_leaves_open_is_not_averaged_away(coupling: str) -> None:
    _, last = flown(0, coupling, UNSURE)
    focal = last.P[E.calibration, E.calibration][0, 0]
    assert 0.3 < focal <= 1.0  # of the declared variance: nothing but the camera tells the distance
    along = np.linalg.eigvalsh(last.P[E.position, E.position])[-1]
    assert np.sqrt(along) > 0.15  # m, 1 % of 30 m is 0.3


def test_an_exact_camera_carries_no_such_states() -> None:
    _, records = simulate(
        reference(20.0), load_target("space-rider"), CAMERA, SimulationConfig(TruthConfig(step_s=0.5), SENSING),
        np.random.default_rng(0),
    )  # fmt: skip
    few, more = (setup_of(records, points(), c, NavigationConfig()).layout for c in (CAMERA, UNSURE))
    assert (few.n_calibration, more.n_errors - few.n_errors) == (0, 3)


def test_columns_of_keypoints_are_those_of_finite_differences(rng: np.random.Generator) -> None:
    lens = np.array([1407.0, 1400.0, 512.0, 500.0, 0.01, 5.0])
    x = np.zeros(Layout(24, 3).n_states)
    x[X.position], x[X.q_eci_cam], x[X.q_cam_target] = (0.0, 0.0, -30.0), (1.0, 0, 0, 0), (1.0, 0, 0, 0)
    x[X.calibration] = 0.1 * rng.normal(size=3)
    _, H = keypoint_model(x, points(), np.arange(24), TURNING, lens)
    for k in range(3):
        step = np.zeros(len(x))
        step[X.calibration.start + len(x) + k] = 1e-3
        high, low = (keypoint_model(x + s * step, points(), np.arange(24), TURNING, lens)[0] for s in (1.0, -1.0))
        assert H[:, FRAME.pose_error.stop + k] == pytest.approx((high - low) / 2e-3, abs=1e-6)


def test_what_a_pose_owes_to_the_camera_is_taken_out_of_its_noise() -> None:
    _, records = simulate(
        reference(20.0), load_target("space-rider"), UNSURE, SimulationConfig(TruthConfig(step_s=0.5), SENSING),
        np.random.default_rng(0),
    )  # fmt: skip
    poses = records.poses
    assert poses is not None
    fix = PoseFix(0.0, 0.0, poses.q_cam_target[0], poses.t_cam_target_m[0], poses.covariance[0])
    knowing = setup_of(records, points(), UNSURE, NavigationConfig())
    plain = setup_of(records, points(), UNSURE, NavigationConfig(), EXACT)
    whole, rest = noise_of_pose(fix, plain), noise_of_pose(fix, knowing)
    np.testing.assert_array_equal(whole, in_target_axes(fix.covariance, fix.q_cam_target))
    assert np.linalg.eigvalsh(rest).min() > 0.0
    assert rest[2, 2] < 0.2 * whole[2, 2]  # along the line of sight the focal length was nearly all of it
