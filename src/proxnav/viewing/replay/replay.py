"""A run as steps in time: where camera and target were, where they were thought to be, and what the camera saw."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera, Pose, so3
from proxnav.geometry.types import Points
from proxnav.targets.target import Target

World = Literal["target", "ric"]
"""Frame in which everything is drawn: the target's own, or radial, in-track, cross-track about it."""


@dataclass(frozen=True, slots=True, eq=False)
class Placement:
    """Where camera and target are in the world."""

    T_world_cam: Pose
    T_world_target: Pose

    @property
    def T_cam_target(self) -> Pose:
        """Pose of the target in the camera frame."""
        return self.T_world_cam.inverse() @ self.T_world_target


@dataclass(frozen=True, slots=True, eq=False)
class ReplayStep:
    """One instant."""

    t: float
    """Seconds since the replay's epoch."""
    label: str
    """File name of the image, or the time."""
    status: str
    truth: Placement | None = None
    estimate: Placement | None = None
    covariance_m2: Float[np.ndarray, "3 3"] | None = None
    """Covariance of the camera's estimated position, world axes."""
    pose_covariance: Float[np.ndarray, "6 6"] | None = None
    """Covariance of T_cam_target, as PoseResult has it."""
    errors: Float[np.ndarray, "6"] | None = None
    """True less estimated: position [m], attitude [rad], in the axes that `Replay.axes` names."""
    sigmas: Float[np.ndarray, "6"] | None = None
    """Standard deviations claimed for the errors."""
    pixels: Float[np.ndarray, "n_keypoints 2"] | None = None
    """Keypoints that were found [px], NaN where not."""
    covariances_px2: Float[np.ndarray, "n_keypoints 2 2"] | None = None
    image: Path | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Replay:
    """All that is needed to play a run."""

    title: str
    world: World
    camera: Camera
    keypoints_m: Points
    """Keypoints in the target frame."""
    steps: tuple[ReplayStep, ...]
    axes: tuple[str, ...]
    """Six names for the components of the errors."""
    epoch_utc: str = ""
    """Epoch of t; empty where the frames are no sequence: then t counts frames, one a second."""
    target: Target | None = None
    """Mesh to show; None where it cannot be found."""

    @property
    def is_sequence(self) -> bool:
        """Whether neighbouring steps are neighbours in time."""
        return bool(self.epoch_utc)


def position_covariance(T_cam_target: Pose, covariance: Float[np.ndarray, "6 6"]) -> Float[np.ndarray, "3 3"]:
    """Covariance of the camera's position in target axes [m^2], from that of T_cam_target.

    r = -R^T t, with t + dt and exp(dr) R: dr_target = -R^T (dt + [t]x dr).
    """
    J = -T_cam_target.R.T @ np.concatenate([np.eye(3), so3.skew(T_cam_target.t_m)], axis=1)
    return J @ covariance @ J.T
