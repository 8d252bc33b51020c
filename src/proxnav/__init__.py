"""Relative navigation from one camera: where is the spacecraft in front of me, and how sure is that?

>>> import proxnav as pn
>>> camera = pn.Camera(width=1024, height=1024, fx=1407.0, fy=1407.0, cx=512.0, cy=512.0)
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_PUBLIC = {
    "Camera": "proxnav.geometry.camera",
    "InputError": "proxnav.errors",
    "Keypoints": "proxnav.records",
    "Pose": "proxnav.geometry.pose",
    "PoseEstimator": "proxnav.estimator",
    "PoseResult": "proxnav.records",
    "Target": "proxnav.targets.target",
    "Trajectory": "proxnav.records",
    "estimate_pose": "proxnav.pose.solve.estimate",
    "pose_errors": "proxnav.geometry.pose_errors",
}
"""Name to module: each is imported when first used, so that `import proxnav` costs milliseconds."""

__all__ = [
    "Camera",
    "InputError",
    "Keypoints",
    "Pose",
    "PoseEstimator",
    "PoseResult",
    "Target",
    "Trajectory",
    "__version__",
    "estimate_pose",
    "pose_errors",
]

if TYPE_CHECKING:
    from proxnav.errors import InputError
    from proxnav.estimator import PoseEstimator
    from proxnav.geometry.camera import Camera
    from proxnav.geometry.pose import Pose
    from proxnav.geometry.pose_errors import pose_errors
    from proxnav.pose.solve.estimate import estimate_pose
    from proxnav.records import Keypoints, PoseResult, Trajectory
    from proxnav.targets.target import Target


def __getattr__(name: str) -> Any:
    if name not in _PUBLIC:
        raise AttributeError(f"module 'proxnav' has no attribute '{name}'")
    return getattr(import_module(_PUBLIC[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
