"""Keypoints that agree only when they are read in another way: as a mirror image, or as pixels of another picture.

A wrong reading leaves a pose on which many points agree by chance. What tells it from honest keypoints with outliers is
that the other reading explains nearly all of them.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float
from scipy.special import fdtrc

from proxnav.geometry import Camera, Pose
from proxnav.geometry.pose_jacobian import pose_jacobian
from proxnav.geometry.types import Flags
from proxnav.pose.solve.config import PoseConfig
from proxnav.pose.solve.consensus import Fit, agrees, fit_consensus, rms_px
from proxnav.pose.solve.intake import Correspondences
from proxnav.pose.solve.noise import fit_at_unknown_noise

_FEWEST = 6
_DOUBTFUL = 0.25
"""Share of points off the pose from which on the mirror image is tried."""
_GAIN = 0.25
"""Share of the points that must agree as a mirror image beyond those that agree as they are."""
_NEARLY_ALL = 0.85
"""Share of the points that must agree as a mirror image."""
_NOISY = 1.5
"""Noise over what is expected from which on the mirror image is tried although most points agree."""
_ODDS = 12.0
"""Log of the likelihood by which the mirror image must fit better where as many points agree on it."""
_NORMALISED_PX = 2.0
"""Pixels that all lie below this are shares of the image."""
_CORNER = 0.6
"""Share of the image, from its corner on, that holds the pixels of a crop."""
_TOUCHES = 0.25
"""A crop's pixels begin this near to 0, over where they end."""
_SHIFTED = 0.1
"""Share of the image by which the principal point must be off for the pixels to be those of a crop."""
_CHANCE = 1e-4
"""Chance at which honest noise looks like another principal point."""


def is_normalised(data: Correspondences) -> bool:
    """Whether the pixels are shares of the image's size: all of them lie in its first pixels."""
    return bool((data.pixels >= 0.0).all() and data.pixels.max() <= _NORMALISED_PX)


def is_mirrored(
    fit: Fit | None, data: Correspondences, camera: Camera, noise_unknown: bool, config: PoseConfig
) -> bool:
    """Whether many more points agree on a pose as a mirror image than as they are, or as many and far better.

    Exchanged axes, an axis that counts from the other side, and points named left for right all are mirror images.
    """
    n = len(data.X)
    found = 0 if fit is None else int(np.count_nonzero(fit.use))
    spread = 0.0 if fit is None or found == 0 else rms_px(fit, data)
    agree, noisy = found > (1.0 - _DOUBTFUL) * n, noise_unknown and spread > _NOISY * config.sigma_px
    if n < _FEWEST or (agree and not noisy):
        return False
    image = _mirrored(data, camera)
    other = fit_at_unknown_noise(image, config) if noise_unknown else fit_consensus(image, 1.0, config)
    if other is None or not agrees(other, image, config):
        return False
    mirrored = int(np.count_nonzero(other.use))
    if mirrored < _NEARLY_ALL * n:
        return False
    likelier = 2.0 * found * np.log(max(spread, 1e-9) / max(rms_px(other, image), 1e-9)) > _ODDS if noisy else False
    return mirrored >= found + max(2.0, _GAIN * n) or (mirrored >= found and bool(likelier))


def _mirrored(data: Correspondences, camera: Camera) -> Correspondences:
    """The points with x counted from the other side of the principal point."""
    flip = np.array([-1.0, 1.0])
    return replace(
        data, pixels=data.pixels * flip + (2.0 * camera.cx, 0.0), xy=data.xy * flip,
        covariances=data.covariances * np.outer(flip, flip), calibration_px=None,
    )  # fmt: skip


def is_of_a_crop(fit: Fit, data: Correspondences, T_cam_target: Pose, camera: Camera) -> bool:
    """Whether the pixels lie in the image's first corner and say that the principal point is far from where it is.

    F test of one Gauss-Newton step on pose, focal length and principal point against one on the pose alone.
    """
    size = min(camera.width, camera.height)
    high = float(data.pixels.max())
    if high > _CORNER * size or float(data.pixels.min(axis=0).max()) > _TOUCHES * high:
        return False
    for points in (fit.use, np.ones(len(data.X), dtype=bool)):
        chance, shift_px = _other_camera(points, data, T_cam_target, camera)
        if chance < _CHANCE and shift_px > _SHIFTED * size:
            return True
    return False


def _other_camera(chosen: Flags, data: Correspondences, T_cam_target: Pose, camera: Camera) -> tuple[float, float]:
    """(chance that a right camera leaves such residuals, how far off the principal point seems [px])."""
    points = data.X[chosen] + data.centroid
    seen = camera.project(T_cam_target @ points)
    residual = (data.pixels[chosen] - seen).ravel()
    J = pose_jacobian(T_cam_target, points, camera).reshape(len(residual), 6)
    C = np.zeros((len(points), 2, 3))
    C[..., 0], C[:, 0, 1], C[:, 1, 2] = seen - (camera.cx, camera.cy), 1.0, 1.0
    J = J / np.linalg.norm(J, axis=0)
    both = np.hstack([J, C.reshape(len(residual), 3)])
    of_pose = _squares_left(J, residual)
    step, *_ = np.linalg.lstsq(both, residual, rcond=None)
    left = float(np.sum((residual - both @ step) ** 2))
    free = len(residual) - 9
    if free < 1:
        return 1.0, 0.0
    f = (of_pose - left) / 3.0 / max(left / free, 1e-12)
    return float(fdtrc(3, free, max(f, 0.0))), float(np.linalg.norm(step[7:]))


def _squares_left(A: Float[np.ndarray, "n k"], b: Float[np.ndarray, "n"]) -> float:
    return float(np.sum((b - A @ np.linalg.lstsq(A, b, rcond=None)[0]) ** 2))
