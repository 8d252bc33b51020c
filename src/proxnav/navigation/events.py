"""Readings of all sensors as one stream in the order of arrival, and what each does to a belief."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from proxnav.geometry import quaternion
from proxnav.navigation.belief import Belief, Scene
from proxnav.navigation.observe import Verdict, take_gnss, take_keypoints, take_pose, take_star_fix
from proxnav.navigation.propagate import Step, propagate, take_force, take_gyro
from proxnav.navigation.start import can_start, disagrees_with_control, start
from proxnav.records import SensorRecords

Kind = Literal["gyro", "accelerometer", "star_tracker", "gnss", "poses", "keypoints"]

ORDER: tuple[Kind, ...] = ("gyro", "accelerometer", "star_tracker", "gnss", "poses", "keypoints")
"""Of readings taken at the same instant: first what moves the belief there, and a pose before its own keypoints."""

_APPLIED = Verdict("accepted")


@dataclass(frozen=True, slots=True, eq=False)
class Event:
    """One reading."""

    t: float
    """When it was taken."""
    received: float
    kind: Kind
    values: Any
    """A tuple, as the sensor's record has it."""

    @property
    def rank(self) -> tuple[float, int]:
        """Order of application."""
        return self.t, ORDER.index(self.kind)


def apply(belief: Belief, event: Event, scene: Scene, steps: list[Step] | None = None) -> tuple[Belief, Verdict]:
    """The belief after a reading, which may not be older than the belief."""
    if event.kind == "gyro":
        return take_gyro(belief, event.t, event.values[0], scene, steps), _APPLIED
    if event.kind == "accelerometer":
        return take_force(belief, event.t, event.values, scene, steps), _APPLIED
    belief = propagate(belief, event.t, scene, steps)
    if event.kind == "star_tracker":
        q, sigma = event.values
        return take_star_fix(belief, event.t, q, sigma, scene)
    if event.kind == "gnss":
        position, velocity, *sigmas = event.values
        return take_gnss(belief, position, velocity, (sigmas[0], sigmas[1]), scene)
    if event.kind == "poses":
        return _take_pose(belief, event, scene)
    pixels, cov = event.values
    return take_keypoints(belief, pixels, cov, scene)


def _take_pose(belief: Belief, event: Event, scene: Scene) -> tuple[Belief, Verdict]:
    """Starts the filter where it needs that; with loose coupling the pose is also measured."""
    q, t_m, cov = event.values
    started = can_start(belief)
    if started and disagrees_with_control(belief, q, cov, scene):
        return belief, Verdict("gated")
    if started:
        belief = start(belief, q, t_m, cov, scene)
    if scene.config.coupling == "loose":
        belief, verdict = take_pose(belief, q, t_m, cov, scene)
        return belief, Verdict("started", verdict.nis, verdict.dof) if started else verdict
    return belief, Verdict("started" if started else "not_started")


def events(records: SensorRecords, scene: Scene) -> list[Event]:
    """All readings in the order of arrival; of the camera what the coupling uses, poses always for starting."""
    found = [*_inertial(records, scene), *_fixes(records, scene), *_frames(records, scene)]
    return sorted(found, key=lambda event: event.received)


def _inertial(records: SensorRecords, scene: Scene) -> Iterator[Event]:
    if records.gyro is not None and scene.has_gyro:
        for t, rate in zip(records.gyro.t.tolist(), records.gyro.rate, strict=True):
            yield Event(t, t, "gyro", (rate,))
    if records.accelerometer is not None and scene.config.accelerometer != "never":
        a, before = records.accelerometer, None
        for t, force, thrust in zip(a.t.tolist(), a.specific_force, a.thrust.tolist(), strict=True):
            if before is not None and 0.0 < t - before < 2.0:
                yield Event(t, t, "accelerometer", (force, thrust, t - before))
            before = t


def _fixes(records: SensorRecords, scene: Scene) -> Iterator[Event]:
    if (s := records.star_tracker) is not None:
        q = quaternion.normalize(s.q_eci_cam)
        for i in range(len(s.t)):
            yield Event(float(s.t[i]), float(s.received[i]), "star_tracker", (q[i], s.sigma_rad[i]))
    if (g := records.gnss) is not None and scene.config.gnss:
        for i in range(len(g.t)):
            sigmas = (float(g.sigma_position_m[i]), float(g.sigma_velocity_mps[i]))
            yield Event(float(g.t[i]), float(g.received[i]), "gnss", (g.position_m[i], g.velocity_mps[i], *sigmas))


def _frames(records: SensorRecords, scene: Scene) -> Iterator[Event]:
    if (p := records.poses) is not None:
        q = quaternion.normalize(p.q_cam_target)
        for i in range(len(p.t)):
            values = (q[i], p.t_cam_target_m[i], p.covariance[i])
            yield Event(float(p.t[i]), float(p.received[i]), "poses", values)
    if (k := records.keypoints) is not None and scene.config.coupling == "tight":
        pixels, cov = straightened(k.pixels, k.covariances_px2, scene)
        for i in range(len(k.t)):
            yield Event(float(k.t[i]), float(k.received[i]), "keypoints", (pixels[i], cov[i]))


def straightened(pixels: np.ndarray, cov: np.ndarray, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Pixels (n, k, 2) and covariances of a camera with distortion as one without would have them."""
    camera = scene.real_camera
    if not camera.is_distorted:
        return pixels, cov
    rays = camera.unproject(pixels)
    J = camera.projection_jacobian(rays)[..., :2]
    back = np.linalg.inv(np.where(np.isfinite(J), J, np.eye(2))) * np.array([[scene.camera.fx], [scene.camera.fy]])
    return scene.camera.project(rays), back @ cov @ np.swapaxes(back, -1, -2)
