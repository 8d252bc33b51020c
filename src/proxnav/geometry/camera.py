"""The pinhole camera with lens distortion, in corner-origin pixels.

Axes: x right, y down, z forward. Image: [0, width] x [0, height], the first pixel's centre is (0.5, 0.5).
"""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from proxnav.errors import InputError
from proxnav.geometry import distortion as lens
from proxnav.geometry.types import Pixels, Vector3


@dataclass(frozen=True)
class Camera:
    """Intrinsics [px] and Brown-Conrady distortion (k1, k2, p1, p2, k3).

    >>> camera = Camera(width=1024, height=1024, fx=1407.0, fy=1407.0, cx=512.0, cy=512.0)
    >>> camera.project(np.array([1.0, 0.0, 10.0]))
    array([652.7, 512. ])
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if self.width < 1 or self.height < 1 or not (self.fx > 0 and self.fy > 0):
            raise InputError(
                f"a camera needs positive size and focal length, found {self.width}x{self.height} px, "
                f"fx {self.fx}, fy {self.fy}"
            )
        values = (self.fx, self.fy, self.cx, self.cy, *self.distortion)
        if len(self.distortion) != 5 or not np.isfinite(values).all():
            raise InputError(f"a camera needs finite intrinsics and 5 distortion terms, found {values}")
        object.__setattr__(self, "distortion", tuple(float(value) for value in self.distortion))

    @staticmethod
    def from_speed_json(path: str | Path) -> "Camera":
        """The camera of a SPEED+ `camera.json` (focal length in metres, matrix in pixels)."""
        from proxnav.geometry.camera_files import read_speed_json

        return read_speed_json(Path(path))

    @cached_property
    def K(self) -> Float[np.ndarray, "3 3"]:
        """Matrix of intrinsics [px], corner origin."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    @property
    def is_distorted(self) -> bool:
        """Whether any distortion term differs from zero."""
        return any(self.distortion)

    @cached_property
    def _fold_radius(self) -> float:
        return lens.fold_radius(self.distortion)

    def project(self, points_cam_m: Vector3) -> Pixels:
        """Points (..., 3) [m] to pixels (..., 2); NaN behind the camera and where the distortion folds back."""
        points = np.asarray(points_cam_m, dtype=np.float64)
        z = points[..., 2:]
        with np.errstate(divide="ignore", invalid="ignore"):
            xy = np.where(z > 0.0, points[..., :2] / z, np.nan)
        if self.is_distorted:
            inside = np.linalg.norm(xy, axis=-1, keepdims=True) <= self._fold_radius
            xy = np.where(inside, lens.distort(xy, self.distortion), np.nan)
        return xy * (self.fx, self.fy) + (self.cx, self.cy)

    def unproject(self, pixels: Pixels) -> Vector3:
        """Pixels (..., 2) to rays (..., 3) with z = 1 in the camera frame; NaN where no ray leads there."""
        pixels = np.asarray(pixels, dtype=np.float64)
        xy = (pixels - (self.cx, self.cy)) / (self.fx, self.fy)
        if self.is_distorted:
            xy = lens.undistort(xy, self.distortion)
        return np.concatenate([xy, np.ones_like(xy[..., :1])], axis=-1)

    def projection_jacobian(self, points_cam_m: Vector3) -> Float[np.ndarray, "*batch 2 3"]:
        """d(pixels)/d(points) [px/m], distortion included."""
        x, y, z = np.moveaxis(np.asarray(points_cam_m, dtype=np.float64), -1, 0)
        zero = np.zeros_like(x)
        ideal = np.stack(
            [np.stack([1.0 / z, zero, -x / z**2], axis=-1), np.stack([zero, 1.0 / z, -y / z**2], axis=-1)], axis=-2
        )
        if self.is_distorted:
            ideal = lens.jacobian(np.stack([x / z, y / z], axis=-1), self.distortion) @ ideal
        return ideal * np.array([[self.fx], [self.fy]])

    def contains(self, pixels: Pixels) -> Bool[np.ndarray, "*batch"]:
        """Whether pixels (..., 2) lie in the image; False for NaN."""
        return np.asarray(((pixels >= 0.0) & (pixels <= (self.width, self.height))).all(axis=-1))

    def cropped(self, x: float | int, y: float | int, width: int, height: int) -> "Camera":
        """The camera of the window whose upper left corner is (x, y) [px]."""
        return replace(self, width=width, height=height, cx=self.cx - x, cy=self.cy - y)

    def resized(self, width: int, height: int) -> "Camera":
        """The camera of the same image resampled to another size."""
        sx, sy = width / self.width, height / self.height
        return replace(
            self, width=width, height=height, fx=self.fx * sx, fy=self.fy * sy, cx=self.cx * sx, cy=self.cy * sy
        )

    def undistorted(self) -> "Camera":
        """The same intrinsics without distortion."""
        return replace(self, distortion=(0.0,) * 5)

    def to_opencv(self) -> tuple[Float[np.ndarray, "3 3"], Float[np.ndarray, "5"]]:
        """(matrix, distortion) in OpenCV's pixel-centre origin: cx and cy are half a pixel smaller."""
        K = self.K.copy()
        K[:2, 2] -= 0.5
        return K, np.array(self.distortion)

    @staticmethod
    def from_opencv(
        K: Float[np.ndarray, "3 3"], distortion: Float[np.ndarray, "n"], width: int, height: int
    ) -> "Camera":
        """Inverse of `to_opencv`."""
        k = (float(distortion[0]), *(float(value) for value in distortion[1:5]))
        return Camera(width, height, K[0, 0], K[1, 1], K[0, 2] + 0.5, K[1, 2] + 0.5, k)  # pyright: ignore
