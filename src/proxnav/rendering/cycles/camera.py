"""Our camera and axes as Blender wants them; Blender's axes (x right, y up, z backward) exist only in this room."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera, Pose
from proxnav.geometry.arrays import unit
from proxnav.geometry.types import Vector3

SENSOR_WIDTH_MM = 36.0
_FLIP = np.diag([1.0, -1.0, -1.0])  # R_cam_blender: x right, y up, z backward


@dataclass(frozen=True)
class BlenderView:
    """Camera settings of Blender for a pinhole camera, `sensor_fit` HORIZONTAL."""

    width: int
    height: int
    aspect_x: float
    """Pixel aspect; Blender takes 1 to 200 only, so the smaller of the two is 1."""
    aspect_y: float
    sensor_width: float
    """mm."""
    lens: float
    """mm."""
    shift_x: float
    """Shift of the view to the right, in image widths."""
    shift_y: float
    """Shift of the view upwards, in image widths of square pixels."""


def to_blender(camera: Camera) -> BlenderView:
    """The view of `camera` without its distortion; inverse of `from_blender`."""
    ratio = camera.fx / camera.fy
    return BlenderView(
        width=camera.width,
        height=camera.height,
        aspect_x=max(1.0, 1.0 / ratio),
        aspect_y=max(1.0, ratio),
        sensor_width=SENSOR_WIDTH_MM,
        lens=camera.fx * SENSOR_WIDTH_MM / camera.width,
        shift_x=(0.5 * camera.width - camera.cx) / camera.width,
        shift_y=(camera.cy - 0.5 * camera.height) * ratio / camera.width,
    )


def from_blender(view: BlenderView) -> Camera:
    """The camera in corner-origin pixels of a Blender view."""
    ratio = view.aspect_y / view.aspect_x
    fx = view.lens * view.width / view.sensor_width
    cx = view.width * (0.5 - view.shift_x)
    return Camera(view.width, view.height, fx, fx / ratio, cx, 0.5 * view.height + view.shift_y * view.width / ratio)


def camera_matrix(T_cam_target: Pose) -> Float[np.ndarray, "4 4"]:
    """World matrix of Blender's camera object, where the world's axes are the target's."""
    M = T_cam_target.inverse().matrix()
    M[:3, :3] = M[:3, :3] @ _FLIP
    return M


def axes_towards(direction: Vector3) -> Float[np.ndarray, "3 3"]:
    """A rotation whose third column is `direction`: a Sun lamp so turned shines from there."""
    z = unit(np.asarray(direction, dtype=np.float64))
    x = unit(np.cross(np.eye(3)[np.argmin(np.abs(z))], z))
    return np.column_stack([x, np.cross(z, x), z])
