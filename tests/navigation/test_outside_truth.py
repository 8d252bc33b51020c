"""The filter on motion that others made: SHIRT ROE1 (CC BY 4.0, SPEED+ data) and Basilisk's hold (ISC)."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from navigation.flights import CAMERA, points
from navigation.orbits import target_at
from proxnav.evaluation.navigation_errors import NavErrors, mean_nis, nav_errors
from proxnav.flight.attitude_motion import mean_rates
from proxnav.flight.orbit_forces import ForceConfig, fly
from proxnav.flight.sensors.detector import DetectorConfig
from proxnav.flight.simulate import SensingConfig, sense
from proxnav.flight.truth import Truth
from proxnav.flight.truth_files import true_states
from proxnav.geometry import quaternion
from proxnav.geometry.celestial import R_eci_ric
from proxnav.navigation.belief import Tracking
from proxnav.navigation.config import FilterNoise, NavigationConfig
from proxnav.navigation.filter_setup import setup_of
from proxnav.navigation.layout import E, X
from proxnav.navigation.navigator import run_filter
from proxnav.records.error_model import KeypointErrorModel
from proxnav.targets.loading import load_target
from proxnav.trajectories.read import read_trajectory
from proxnav.trajectories.readers.config import ReaderConfig

GOOD = KeypointErrorModel(pose_share=0.05, point_share=0.2, white_share=0.5, tau_s=60.0)
"""A better detector than ours, so that the motion shows."""
STEERED = FilterNoise(acceleration=3e-4)
"""The hold near the geostationary radius is kept by thrusters of which no accelerometer tells: up to 5e-5 m/s^2 for
minutes."""
MIDDLE_OF_TANGO_M = np.array([0.0, 0.019, 0.161])
"""Centre of mass of SHIRT's target, whose origin lies on its bottom face."""
EPOCH = "2024-11-01T00:00:00Z"


def interpolated_attitude(t: np.ndarray, q: np.ndarray, at: np.ndarray) -> np.ndarray:
    k = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
    return quaternion.slerp(q[k], q[k + 1], (at - t[k]) / (t[k + 1] - t[k]))


def truth_of(t: np.ndarray, target: tuple, chaser: tuple, q_eci_target: np.ndarray, q_eci_cam: np.ndarray) -> Truth:
    step = float(t[1] - t[0])
    (r_t, v_t), (r_c, v_c) = target, chaser
    return Truth(
        EPOCH, t, r_t, v_t, r_c, v_c, q_eci_target, q_eci_cam, mean_rates(q_eci_target, step),
        mean_rates(q_eci_cam, step), np.zeros((len(t), 3)),
    )  # fmt: skip


def flown(truth: Truth, noise: FilterNoise, seed: int) -> tuple[NavErrors, dict, int]:
    """The filter for a free target over our sensors along somebody else's motion."""
    sensing = SensingConfig(DetectorConfig(sigma_px=2.0, sigma_m=0.0, errors=GOOD), gnss="code", accelerometer=None)
    records = sense(truth, load_target("space-rider"), CAMERA, sensing, np.random.default_rng(seed))
    setup = setup_of(
        records, points(), CAMERA, NavigationConfig(coupling="tight", target="free", noise=replace(noise, camera=GOOD))
    )
    t = np.arange(truth.t[0] + 5.0, truth.t[-1], 5.0)
    states, judged, last = run_filter(records, setup, t)
    return nav_errors(states, true_states(truth).at(t)), mean_nis(judged, truth.t[0] + 30.0), last.memory.starts


def shirt(shared_data: Path, seconds: float) -> Truth:
    """ROE1: a hold on V-bar at 8 m from a spinning target. The file gives poses; orbit and pointing are ours."""
    poses = json.loads((shared_data / "speedplus" / "shirt_roe1.json").read_text())["poses"]
    given = 5.0 * np.arange(len(poses))
    t = np.arange(0.0, seconds, 0.5)
    q_cam_target = interpolated_attitude(given, np.array([p["q_vbs2tango_true"] for p in poses]), t)
    place = CubicSpline(given, np.array([p["r_Vo2To_vbs_true"] for p in poses]))
    r, v = target_at(0.0, 0.0)
    states = fly(np.concatenate([r, v, r, v]), t, ForceConfig(density_kg_m3=0.0))[:, :6]
    R_eci_target_ric = R_eci_ric(states[:, :3], states[:, 3:])
    R_ric_cam = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])  # looks along the flight
    q_eci_cam = quaternion.from_matrix(R_eci_target_ric @ R_ric_cam)
    relative = -quaternion.rotate(q_eci_cam, place(t))
    chaser = CubicSpline(t, states[:, :3] + relative)
    return truth_of(
        t, (states[:, :3], states[:, 3:]), (chaser(t), chaser(t, 1)), quaternion.multiply(q_eci_cam, q_cam_target),
        q_eci_cam,
    )  # fmt: skip


def basilisk(shared_data: Path, seconds: float) -> Truth:
    """Two craft 10 m apart near the geostationary radius; the second turns slowly."""
    flight = read_trajectory(
        [str(shared_data / "basilisk" / "scHoldTraj_rotating_EP.csv")], ReaderConfig(frame="J2000")
    )
    t = np.arange(flight.t[0], flight.t[0] + seconds, 0.5)
    target = CubicHermiteSpline(flight.t, flight.r_eci_target_m, flight.v_eci_target_mps)
    chaser = CubicHermiteSpline(flight.t, flight.r_eci_chaser_m, flight.v_eci_chaser_mps)
    return truth_of(
        t, (target(t), target(t, 1)), (chaser(t), chaser(t, 1)),
        interpolated_attitude(flight.t, flight.q_eci_target, t), interpolated_attitude(flight.t, flight.q_eci_cam, t),
    )  # fmt: skip


def test_the_spinning_target_of_shirt_roe1_is_followed_and_shows_where_its_centre_of_mass_is(shared_data: Path) -> None:
    truth = shirt(shared_data, 400.0)
    records = sense(
        truth, load_target("space-rider"), CAMERA, SensingConfig(accelerometer=None), np.random.default_rng(0)
    )
    setup = setup_of(records, points(), CAMERA, NavigationConfig(target="free"))
    t = np.arange(truth.t[0] + 5.0, truth.t[-1], 5.0)
    states, judged, last = run_filter(records, setup, t)
    found, nis, late = nav_errors(states, true_states(truth).at(t)), mean_nis(judged, truth.t[0] + 30.0), t > 100.0
    assert isinstance(last, Tracking)
    assert last.memory.starts == 1
    assert np.linalg.norm(found.errors[late, :3], axis=1).max() < 0.1  # m at 8 m
    assert 4.0 < np.nanmean(found.nees) < 18.0  # 12 on average; one flight says little more
    assert np.nanmean(found.inside_3_sigma) > 0.99
    assert all(0.7 < value < 1.3 for value, _ in nis.values()), nis
    off = last.x[X.target_centre] - MIDDLE_OF_TANGO_M
    assert (np.abs(off) < 3.0 * np.sqrt(np.diagonal(last.P)[E.target_centre])).all()
    assert np.abs(off[1:]).max() < 0.02  # m: across the axis of the spin


def test_basilisks_hold_at_geostationary_radius_is_followed(shared_data: Path) -> None:
    found, nis, starts = flown(basilisk(shared_data, 400.0), STEERED, 0)
    late = found.t > 100.0
    assert starts == 1
    assert np.linalg.norm(found.errors[late, :3], axis=1).max() < 0.1  # m at 10 m
    assert np.nanmean(found.inside_3_sigma) > 0.98
    assert all(0.7 < value < 1.3 for value, _ in nis.values()), nis
