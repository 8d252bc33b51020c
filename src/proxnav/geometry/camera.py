"""The pinhole camera with lens distortion, in corner-origin pixels.

Axes: x right, y down, z forward. Image: [0, width] x [0, height], the first pixel's centre is (0.5, 0.5).
"""

import warnings
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float

from proxnav.errors import InputError, InputNote
from proxnav.geometry import distortion as pinhole
from proxnav.geometry import fisheye
from proxnav.geometry.calibration import EXACT, CalibrationSigma
from proxnav.geometry.types import Pixels, Vector3

Projection = Literal["pinhole", "fisheye"]
"""How angles become image radii: by their tangent, or by the angle itself."""
_WIDE_BOW, _BOW = 0.2, 0.01


@dataclass(frozen=True)
class Camera:
    """Intrinsics [px] and lens distortion in OpenCV's order of coefficients.

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
    distortion: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0, 0.0)
    """pinhole: 4, 5, 8, 12 or 14 of k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tx, ty (no tilt: tx = ty = 0), kept
    as the shortest of 5, 8 and 12 that says the same. fisheye: k1, k2, k3, k4."""
    projection: Projection = "pinhole"
    """fisheye: the model of OpenCV's fisheye module (Kannala-Brandt), Kalibr's and ROS's equidistant."""
    calibration_sigma: CalibrationSigma = EXACT
    """What is not known about the intrinsics; covariances of poses hold it."""

    def __post_init__(self) -> None:
        if self.width < 1 or self.height < 1 or not (self.fx > 0 and self.fy > 0):
            raise InputError(
                f"a camera needs positive size and focal length, found {self.width}x{self.height} px, "
                f"fx {self.fx}, fy {self.fy}"
            )
        values = (self.fx, self.fy, self.cx, self.cy, *self.distortion)
        if not np.isfinite(values).all():
            raise InputError(f"a camera needs finite intrinsics and distortion, found {values}")
        object.__setattr__(self, "distortion", _coefficients(self.distortion, self.projection))

    @staticmethod
    def read(path: str | Path) -> "Camera":
        """The camera of any calibration file: OpenCV, ROS, Kalibr, MATLAB, npz, SPEED+ or plain numbers.

        Which it is shows in its content; `FILE#cam1` names one of several cameras. Pixels are converted to corner
        origin; what was converted or assumed is said by an `InputNote`, a warning.
        """
        from proxnav.geometry.camera_files import read_camera_file

        found = read_camera_file(path)
        for note in found.notes:
            warnings.warn(f"{path}: {note}", InputNote, stacklevel=2)
        return found.camera

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
        """Whether the image differs from that of a pinhole."""
        return self.projection == "fisheye" or any(self.distortion)

    @property
    def bow(self) -> float:
        """Share of a straight edge's extent in the image by which its middle may lie outside the box of its ends."""
        if not self.is_distorted:
            return 0.0
        return _BOW if self.projection == "pinhole" and len(self.distortion) == 5 else _WIDE_BOW

    @cached_property
    def fold_radius(self) -> float:
        """Largest |(x/z, y/z)| of a ray that has an image; beyond it the lens would fold the image back."""
        if not self.is_distorted:
            return float("inf")
        return _model(self.projection).fold_radius(self.distortion)

    def project(self, points_cam_m: Vector3) -> Pixels:
        """Points (..., 3) [m] to pixels (..., 2); NaN behind the camera and where the distortion folds back."""
        points = np.asarray(points_cam_m, dtype=np.float64)
        z = points[..., 2:]
        with np.errstate(divide="ignore", invalid="ignore"):
            xy = np.where(z > 0.0, points[..., :2] / z, np.nan)
        if self.is_distorted:
            inside = np.linalg.norm(xy, axis=-1, keepdims=True) <= self.fold_radius
            xy = np.where(inside, _model(self.projection).distort(xy, self.distortion), np.nan)
        return xy * (self.fx, self.fy) + (self.cx, self.cy)

    def unproject(self, pixels: Pixels) -> Vector3:
        """Pixels (..., 2) to rays (..., 3) with z = 1 in the camera frame; NaN where no ray leads there."""
        pixels = np.asarray(pixels, dtype=np.float64)
        xy = (pixels - (self.cx, self.cy)) / (self.fx, self.fy)
        if self.is_distorted:
            xy = _model(self.projection).undistort(xy, self.distortion)
        return np.concatenate([xy, np.ones_like(xy[..., :1])], axis=-1)

    def projection_jacobian(self, points_cam_m: Vector3) -> Float[np.ndarray, "*batch 2 3"]:
        """d(pixels)/d(points) [px/m], distortion included."""
        x, y, z = np.moveaxis(np.asarray(points_cam_m, dtype=np.float64), -1, 0)
        zero = np.zeros_like(x)
        ideal = np.stack(
            [np.stack([1.0 / z, zero, -x / z**2], axis=-1), np.stack([zero, 1.0 / z, -y / z**2], axis=-1)], axis=-2
        )
        if self.is_distorted:
            ideal = self.lens_jacobian(np.stack([x / z, y / z], axis=-1)) @ ideal
        return ideal * np.array([[self.fx], [self.fy]])

    def lens_jacobian(self, xy: Pixels) -> Float[np.ndarray, "*batch 2 2"]:
        """d(distorted)/d(ideal) of the normalised image coordinates at the ideal ones (x/z, y/z)."""
        return _model(self.projection).jacobian(xy, self.distortion)

    def contains(self, pixels: Pixels) -> Bool[np.ndarray, "*batch"]:
        """Whether pixels (..., 2) lie in the image; False for NaN."""
        return np.asarray(((pixels >= 0.0) & (pixels <= (self.width, self.height))).all(axis=-1))

    def cropped(self, x: float | int, y: float | int, width: int, height: int) -> "Camera":
        """The camera of the window whose upper left corner is (x, y) [px]."""
        return replace(self, width=width, height=height, cx=self.cx - x, cy=self.cy - y)

    def resized(self, width: int, height: int) -> "Camera":
        """The camera of the same image resampled to another size."""
        sx, sy = width / self.width, height / self.height
        sigma = self.calibration_sigma
        if not sigma.is_exact:
            sigma = replace(sigma, principal_px=sigma.principal_px * float(np.sqrt(sx * sy)))
        return replace(
            self, width=width, height=height, fx=self.fx * sx, fy=self.fy * sy, cx=self.cx * sx, cy=self.cy * sy,
            calibration_sigma=sigma,
        )  # fmt: skip

    def undistorted(self) -> "Camera":
        """The pinhole of the same intrinsics without distortion."""
        return replace(self, distortion=(0.0,) * 5, projection="pinhole")

    def erring(self, errors: Float[np.ndarray, "calibration=3"]) -> "Camera":
        """A camera that differs from this one by so many standard deviations of its calibration, and is exact.

        errors: of the focal length, of the principal point along x and along y.
        """
        sigma = self.calibration_sigma
        if sigma.is_exact:
            return self
        stretch, (x, y) = 1.0 + sigma.focal * float(errors[0]), sigma.principal_px * np.asarray(errors[1:])
        return replace(
            self, fx=self.fx * stretch, fy=self.fy * stretch, cx=self.cx + float(x), cy=self.cy + float(y),
            calibration_sigma=EXACT,
        )  # fmt: skip

    def to_opencv(self) -> tuple[Float[np.ndarray, "3 3"], Float[np.ndarray, "n"]]:
        """(matrix, distortion) in OpenCV's pixel-centre origin: cx and cy are half a pixel smaller.

        For `cv2.projectPoints` and its kin, or for those of `cv2.fisheye` where `projection` is fisheye.
        """
        K = self.K.copy()
        K[:2, 2] -= 0.5
        return K, np.array(self.distortion)

    @staticmethod
    def from_opencv(
        K: Float[np.ndarray, "3 3"], distortion: Float[np.ndarray, "n"], width: int, height: int,
        projection: Projection = "pinhole",
    ) -> "Camera":  # fmt: skip
        """Inverse of `to_opencv`; 4, 5, 8, 12 or 14 coefficients of a pinhole, 4 of a fisheye."""
        k = tuple(float(value) for value in np.ravel(distortion))
        return Camera(
            width, height, float(K[0, 0]), float(K[1, 1]), float(K[0, 2]) + 0.5, float(K[1, 2]) + 0.5, k, projection
        )


def _model(projection: Projection) -> ModuleType:
    """The lens model: one of two modules of the same functions."""
    return fisheye if projection == "fisheye" else pinhole


def _coefficients(given: tuple[float, ...], projection: Projection) -> tuple[float, ...]:
    """In the form that the lens models take; InputError for a number of them that no model has."""
    k = tuple(float(value) for value in given)
    if projection == "fisheye":
        if len(k) != fisheye.COUNT:
            raise InputError(f"a fisheye camera has 4 distortion coefficients, found {len(k)}")
        return k
    if projection != "pinhole":
        raise InputError(f"a camera's projection is pinhole or fisheye, found {projection!r}")
    if len(k) not in (0, 4, *pinhole.COUNTS, 14):
        raise InputError(f"a camera has 4, 5, 8, 12 or 14 distortion coefficients in OpenCV's order, found {len(k)}")
    if any(k[12:]):
        raise InputError(f"a tilted sensor (tx {k[12]:g}, ty {k[13]:g}) is not modelled: calibrate without tilt")
    k = k[:12] + (0.0,) * (5 - len(k))
    return next(k[:count] for count in pinhole.COUNTS if not any(k[count:]))
