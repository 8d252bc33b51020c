"""Offsets between clocks: what an attitude that moves unevenly tells of when a reading was really taken."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.geometry.perturbation import TRANSLATION
from proxnav.navigation.monitor.account import AGREES, NOT_COMPARED, Account
from proxnav.navigation.monitor.scene import Scene
from proxnav.navigation.monitor.window import Window

_SIGMAS = 5.0
"""An offset is said when it is so many of its own deviations away from none..."""
LEAST_OFFSET_S = 0.15
"""... and at least so large."""
_DEGREE = 3
"""Degree of the polynomial that the path of a minute is, axis by axis."""
_OUTLIER = 4.0
_LEAST_SAMPLES = 15
_SMOOTH_S = 2.0


@dataclass(frozen=True, slots=True)
class ClockOffset:
    """What has been learnt of one clock against another; windows add up."""

    weighted: float = 0.0
    """Sum of offset / variance."""
    information: float = 0.0
    """Sum of 1 / variance [1/s^2]."""

    def also(self, offset: float, sigma: float) -> "ClockOffset":
        """With another window, which is independent of those before."""
        return ClockOffset(self.weighted + offset / sigma**2, self.information + 1.0 / sigma**2)

    @property
    def offset_s(self) -> float:
        """Best estimate."""
        return self.weighted / self.information if self.information else 0.0

    @property
    def sigma_s(self) -> float:
        """Its standard deviation."""
        return float(self.information**-0.5) if self.information else np.inf

    def account(self, kind: str) -> Account:
        """Whether the clocks agree as far as can be told."""
        if not self.information or self.sigma_s > 1.0:
            return NOT_COMPARED
        if abs(self.offset_s) < max(LEAST_OFFSET_S, _SIGMAS * self.sigma_s):
            return AGREES
        first, second = kind.split(" against ")
        cause = f"this looks like a clock offset of {abs(self.offset_s):.2f} s: what the {first} takes for t was at t "
        cause += f"{'+' if self.offset_s > 0 else '-'} {abs(self.offset_s):.2f} s by the {second}'s clock"
        return Account(1.0, f"clock of {kind}", cause)


def gyro_clock(scene: Scene, known: ClockOffset) -> ClockOffset:
    """With this window's turns: gyro against star tracker."""
    pairs, window = scene.pairs, scene.window
    if pairs is None or len(pairs.t) < _LEAST_SAMPLES:
        return known
    seen = quaternion.log(quaternion.multiply(quaternion.conjugate(pairs.q_first), pairs.q_last))
    y = seen - pairs.turned
    a, b = pairs.t - 0.5 * pairs.span, pairs.t + 0.5 * pairs.span
    column = _rates(window, b) - _rates(window, a)
    scale = 1.0 / pairs.sigma
    basis = np.eye(3) * pairs.span[:, None, None]
    A = np.concatenate([-column[:, :, None], basis], axis=2) * scale[:, :, None]
    return _learnt(A, y * scale, known)


def camera_clock(scene: Scene, known: ClockOffset) -> ClockOffset:
    """With this window's poses: camera against star tracker. A target's path is smooth, a camera's turning is not."""
    sights, window = scene.with_star, scene.window
    if sights is None or len(sights.t) < _LEAST_SAMPLES or len(window.gyro_t) < 4:
        return known
    R_eci_cam, R_ric_eci = quaternion.to_matrix(sights.q_star), np.swapaxes(sights.R_eci_ric, -1, -2)
    R_ric_cam = R_ric_eci @ R_eci_cam
    path = np.einsum("nij,nj->ni", R_ric_cam, sights.position)
    moved = np.cross(_rates(window, sights.t), sights.position)
    column = -np.einsum("nij,nj->ni", R_ric_cam, moved)
    C = R_ric_cam @ sights.covariance[:, TRANSLATION, TRANSLATION] @ np.swapaxes(R_ric_cam, -1, -2)
    whiten = np.linalg.inv(np.linalg.cholesky(C))
    s = (sights.t - sights.t.mean()) / (0.5 * np.ptp(sights.t))
    powers = np.stack([s**k for k in range(_DEGREE + 1)], axis=1)
    basis = np.einsum("nk,ij->nikj", powers, np.eye(3)).reshape(len(s), 3, -1)
    A = whiten @ np.concatenate([column[:, :, None], basis], axis=2)
    return _learnt(A, np.einsum("nij,nj->ni", whiten, path), known)


def _rates(window: Window, at: Float[np.ndarray, "m"]) -> Float[np.ndarray, "m 3"]:
    """Rate at an instant, as a mean over some seconds: noise in what is regressed on would make offsets small."""
    return (window.turned(at + _SMOOTH_S) - window.turned(at - _SMOOTH_S)) / (2.0 * _SMOOTH_S)


def _learnt(A: Float[np.ndarray, "n 3 k"], y: Float[np.ndarray, "n 3"], known: ClockOffset) -> ClockOffset:
    """Least squares for the first unknown, wrong samples left out; its deviation is that of the residuals."""
    keep = np.ones(len(y), dtype=bool)
    for _ in range(3):
        M, b = A[keep].reshape(-1, A.shape[2]), y[keep].ravel()
        x, *_ = np.linalg.lstsq(M, b, rcond=None)
        residual = np.linalg.norm(y - A @ x, axis=1)
        keep = residual < _OUTLIER * max(float(np.median(residual[keep])), 1e-12)
        if keep.sum() < _LEAST_SAMPLES:
            return known
    M, b = A[keep].reshape(-1, A.shape[2]), y[keep].ravel()
    x, *_ = np.linalg.lstsq(M, b, rcond=None)
    rest = M[:, 0] - M[:, 1:] @ np.linalg.lstsq(M[:, 1:], M[:, 0], rcond=None)[0]
    freedom = max(len(b) - M.shape[1], 1)
    variance = float(np.sum((b - M @ x) ** 2)) / freedom
    information = float(rest @ rest)
    if information <= 0.0 or variance <= 0.0:
        return known
    return known.also(float(x[0]), float(np.sqrt(variance / information)))
