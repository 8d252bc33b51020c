"""What Basilisk's recorders kept, as a run folder that `navigate`, `view` and the report read."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.datasets.formats.places import write_camera
from proxnav.datasets.sensor_records.record_files import write_records
from proxnav.evaluation.navigation_errors import NavErrors, nav_errors
from proxnav.evaluation.solution_files import solution_columns
from proxnav.flight.attitude_motion import mean_rates
from proxnav.flight.truth import Truth
from proxnav.flight.truth_files import true_states, write_truth
from proxnav.geometry import Camera, quaternion
from proxnav.geometry.pointing import continuous
from proxnav.live.basilisk.attitude import q_n_b
from proxnav.live.basilisk.camera_config import Mounting
from proxnav.live.basilisk.installed import NANO
from proxnav.navigation.readings import PoseFix
from proxnav.records import EphemerisData, GyroData, NavState, PoseData, SensorRecords, StarTrackerData
from proxnav.storage.tables import write_columns

_STAR_SIGMA_RAD = 5e-5


@dataclass(frozen=True, slots=True)
class Recorders:
    """Recorders of one simulation, all with the same sampling time of at most 120 s."""

    chaser: Any
    """Recorder of the chaser's SCStatesMsg."""
    target: Any
    """Recorder of the target's SCStatesMsg."""
    attitude: Any
    """Recorder of the chaser's NavAttMsg, its star tracker and gyro."""
    orbit: Any
    """Recorder of the chaser's NavTransMsg."""


def recorded_truth(recorders: Recorders, mounting: Mounting, epoch_utc: str) -> Truth:
    """The true states of camera and target. The camera's arm turns with the body."""
    chaser, target = recorders.chaser, recorders.target
    t = NANO * np.array(chaser.times(), dtype=np.float64)
    q_body, q_target = _attitudes(chaser.sigma_BN), _attitudes(target.sigma_BN)
    q_cam = continuous(quaternion.multiply(q_body, np.broadcast_to(mounting.q_body_cam, q_body.shape)))
    rate, arm = np.array(chaser.omega_BN_B), mounting.r_body_cam_m
    eye_r = np.array(chaser.r_BN_N) + quaternion.rotate(q_body, np.broadcast_to(arm, rate.shape))
    eye_v = np.array(chaser.v_BN_N) + quaternion.rotate(q_body, np.cross(rate, arm))
    return Truth(
        epoch_utc, t, np.array(target.r_BN_N), np.array(target.v_BN_N), eye_r, eye_v, q_target, q_cam,
        np.array(target.omega_BN_B), mean_rates(q_cam, float(t[1] - t[0])), np.zeros((len(t), 3)),
    )  # fmt: skip


def write_run(
    folder: Path, truth: Truth, recorders: Recorders, fixes: list[PoseFix], states: list[NavState], camera: Camera,
    mounting: Mounting,
) -> NavErrors:  # fmt: skip
    """Writes records, truth, camera and solution, and returns the errors of the states."""
    folder.mkdir(parents=True, exist_ok=True)
    write_records(folder, _records(truth.epoch_utc, recorders, fixes, mounting))
    write_camera(camera, folder)
    known = true_states(truth)
    write_truth(folder / "truth.csv", known)
    states = [state for state in states if state.t <= truth.t[-1] + 1e-6]
    errors = nav_errors(states, known.at(np.array([state.t for state in states])))
    write_columns(folder / "solution.csv", solution_columns(states, errors))
    return errors


def _records(epoch_utc: str, recorders: Recorders, fixes: list[PoseFix], mounting: Mounting) -> SensorRecords:
    attitude, orbit = recorders.attitude, recorders.orbit
    t = NANO * np.array(attitude.times(), dtype=np.float64)
    q_body = _attitudes(attitude.sigma_BN)
    q_cam = quaternion.multiply(q_body, np.broadcast_to(mounting.q_body_cam, q_body.shape))
    rate = quaternion.rotate(quaternion.conjugate(mounting.q_body_cam), np.array(attitude.omega_BN_B))
    gyro = GyroData(t[1:], 0.5 * (rate[1:] + rate[:-1]))
    stars = StarTrackerData(t, t, q_cam, np.full((len(t), 3), _STAR_SIGMA_RAD))
    at = NANO * np.array(orbit.times(), dtype=np.float64)
    ephemeris = EphemerisData(at, np.array(orbit.r_BN_N), np.array(orbit.v_BN_N))
    return SensorRecords(epoch_utc, ephemeris, gyro=gyro, star_tracker=stars, poses=_poses(fixes))


def _poses(fixes: list[PoseFix]) -> PoseData:
    return PoseData(
        np.array([fix.t for fix in fixes]), np.array([fix.received for fix in fixes]),
        np.array([fix.q_cam_target for fix in fixes]).reshape(-1, 4),
        np.array([fix.t_cam_target_m for fix in fixes]).reshape(-1, 3),
        np.array([fix.covariance for fix in fixes]).reshape(-1, 6, 6),
    )  # fmt: skip


def _attitudes(sigma: Any) -> Float[np.ndarray, "n wxyz=4"]:
    return continuous(np.array([q_n_b(row) for row in np.array(sigma)]))
