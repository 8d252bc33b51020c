"""A run as steps in time: where camera and target were, where they were thought to be, and what the camera saw."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from proxnav.geometry import Camera, Pose, so3
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
class Step:
    """One instant."""

    t: float
    """Seconds since the replay's epoch."""
    label: str
    """File name of the image, or the time."""
    status: str
    truth: Placement | None = None
    estimate: Placement | None = None
    covariance_m2: np.ndarray | None = None
    """(3, 3) of the camera's estimated position, world axes."""
    pose_covariance: np.ndarray | None = None
    """(6, 6) of T_cam_target, as PoseResult has it."""
    errors: np.ndarray | None = None
    """(6,) true less estimated: position [m], attitude [rad], in the axes that `Replay.axes` names."""
    sigmas: np.ndarray | None = None
    """(6,) standard deviations claimed for them."""
    pixels: np.ndarray | None = None
    """(n, 2) keypoints that were found [px], NaN where not."""
    covariances_px2: np.ndarray | None = None
    image: Path | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Replay:
    """All that is needed to play a run."""

    title: str
    world: World
    camera: Camera
    keypoints_m: np.ndarray
    """(n, 3) in the target frame."""
    steps: tuple[Step, ...]
    axes: tuple[str, ...]
    """Six names for the components of the errors."""
    epoch_utc: str = ""
    """Of t; empty where the frames are no sequence: then t counts frames, one a second."""
    target: Target | None = None
    """Mesh to show; None where it cannot be found."""

    @property
    def is_sequence(self) -> bool:
        """Whether neighbouring steps are neighbours in time."""
        return bool(self.epoch_utc)


def position_covariance(T_cam_target: Pose, covariance: np.ndarray) -> np.ndarray:
    """(3, 3) of the camera's position in target axes [m^2], from the (6, 6) of T_cam_target.

    r = -R^T t, with t + dt and exp(dr) R: dr_target = -R^T (dt + [t]x dr).
    """
    J = -T_cam_target.R.T @ np.concatenate([np.eye(3), so3.skew(T_cam_target.t_m)], axis=1)
    return J @ covariance @ J.T
