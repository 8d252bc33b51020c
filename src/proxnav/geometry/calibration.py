"""What is not known about a camera, and how far it moves the image and a pose that is fitted to it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError

N_CALIBRATION = 3
"""Errors of a calibration: focal length, principal point along x, along y."""


@dataclass(frozen=True)
class CalibrationSigma:
    """Standard deviations of the errors of a camera's calibration; zeros for a camera that is known exactly.

    They are the same in every image, so no number of images averages them away.
    """

    focal: float = 0.0
    """Relative error of fx and fy, which err together: 0.001 is 0.1 %."""
    principal_px: float = 0.0
    """Error of the principal point along x, and along y [px]."""

    def __post_init__(self) -> None:
        if not (0.0 <= self.focal < 0.5 and 0.0 <= self.principal_px < 1e4):
            raise InputError(
                "calibration_sigma needs focal, a share from 0 to 0.5, and principal_px of 0 px or more, "
                f"found {self.focal:g} and {self.principal_px:g}"
            )

    @property
    def is_exact(self) -> bool:
        """Whether the camera is taken as exact."""
        return self.focal == 0.0 and self.principal_px == 0.0

    def moves(self, from_axis_px: Float[np.ndarray, "*batch 2"]) -> Float[np.ndarray, "*batch 2 calibration=3"]:
        """Movement [px] of image points, given from the principal point, by one standard deviation of each error.

        d(pixels)/d(ln f) are the pixels from the principal point, whatever the lens.
        """
        out = np.zeros((*from_axis_px.shape, N_CALIBRATION))
        if self.is_exact:
            return out
        out[..., 0] = self.focal * from_axis_px
        out[..., 0, 1] = out[..., 1, 2] = self.principal_px
        return out


EXACT = CalibrationSigma()
"""Nothing is unknown."""


def pose_moves(
    J: Float[np.ndarray, "*batch n 2 6"], W: Float[np.ndarray, "*batch n 2 2"], C: Float[np.ndarray, "*batch n 2 3"]
) -> Float[np.ndarray, "*batch 6 3"]:
    """How far the weighted least-squares pose of n image points moves when the assumed camera moves them by C [px].

    The pose is where sum J^T W (z - h(pose, c)) = 0; by the implicit function theorem, residuals times second
    derivatives left aside, dpose/dc = -(sum J^T W J)^-1 sum J^T W C. J, C: pixels by pose, and by the camera's errors.
    """
    H = np.einsum("...kai,...kab,...kbj->...ij", J, W, J)
    scale = 1.0 / np.sqrt(np.maximum(np.einsum("...ii->...i", H), 1e-300))[..., None]
    pull = np.einsum("...kai,...kab,...kbj->...ij", J, W, C)
    return -scale * np.linalg.solve(H * scale * np.swapaxes(scale, -1, -2), scale * pull)
