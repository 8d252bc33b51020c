"""The last minute of raw readings, as columns in the order of time."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from jaxtyping import Bool, Float

from proxnav.geometry import quaternion
from proxnav.navigation.readings import GnssFix, GyroReading, KeypointFrame, PoseFix, Reading, StarFix

LONGEST_GAP_S = 5.0
"""Between two fixes across which an attitude or a baseline is interpolated."""

_R = TypeVar("_R", GyroReading, StarFix, PoseFix, GnssFix, KeypointFrame)


@dataclass(frozen=True, slots=True, eq=False)
class Window:
    """Columns of each sensor; empty where it said nothing."""

    gyro_t: Float[np.ndarray, "n_gyro"]
    rate: Float[np.ndarray, "n_gyro 3"]
    star_t: Float[np.ndarray, "n_star"]
    q_star: Float[np.ndarray, "n_star wxyz=4"]
    star_sigma: Float[np.ndarray, "n_star 3"]
    pose_t: Float[np.ndarray, "n_pose"]
    q_pose: Float[np.ndarray, "n_pose wxyz=4"]
    position: Float[np.ndarray, "n_pose 3"]
    """The target in camera axes [m]."""
    covariance: Float[np.ndarray, "n_pose 6 6"]
    gnss_t: Float[np.ndarray, "n_gnss"]
    baseline: Float[np.ndarray, "n_gnss 3"]
    gnss_sigma: Float[np.ndarray, "n_gnss"]
    frames: tuple[KeypointFrame, ...]

    @property
    def span_s(self) -> float:
        """From the first fix of the star tracker to the last."""
        return float(np.ptp(self.star_t)) if len(self.star_t) else 0.0

    def attitude(self, t: Float[np.ndarray, "n"]) -> tuple[Float[np.ndarray, "n wxyz=4"], Bool[np.ndarray, "n"]]:
        """(attitude by the star tracker's file at `t`, where two near fixes hold it)."""
        return _slerped(self.star_t, self.q_star, t)

    def turned(self, t: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n 3"]:
        """Integral of the gyro's rates up to `t` [rad], camera axes."""
        steps = np.diff(self.gyro_t, prepend=self.gyro_t[0])
        total = np.cumsum(self.rate * steps[:, None], axis=0)
        return np.stack([np.interp(t, self.gyro_t, column) for column in total.T], axis=1)

    def gyro_covers(self, a: float, b: float) -> bool:
        """Whether the gyro's readings leave no gap between two instants."""
        inside = self.gyro_t[(self.gyro_t > a - 3.0) & (self.gyro_t < b + 3.0)]
        if len(inside) < 2 or inside[0] > a or inside[-1] < b:
            return False
        return bool(np.diff(inside).max() < 2.5)


def window_of(readings: Sequence[Reading], first: float, last: float) -> Window:
    """The readings taken from `first` to `last`, each instant once."""
    gyro, star = _of(GyroReading, readings, first, last), _of(StarFix, readings, first, last)
    pose, gnss = _of(PoseFix, readings, first, last), _of(GnssFix, readings, first, last)
    return Window(
        gyro_t=_column([r.t for r in gyro]), rate=_column([r.rate_cam for r in gyro], 3),
        star_t=_column([r.t for r in star]), q_star=_column([r.q_eci_cam for r in star], 4),
        star_sigma=_column([r.sigma_rad for r in star], 3),
        pose_t=_column([r.t for r in pose]), q_pose=_column([r.q_cam_target for r in pose], 4),
        position=_column([r.t_cam_target_m for r in pose], 3), covariance=_column([r.covariance for r in pose], 6, 6),
        gnss_t=_column([r.t for r in gnss]), baseline=_column([r.position_m for r in gnss], 3),
        gnss_sigma=_column([r.sigma_position_m for r in gnss]),
        frames=tuple(_of(KeypointFrame, readings, first, last)),
    )  # fmt: skip


def interpolated(
    t: Float[np.ndarray, "n"], values: Float[np.ndarray, "n 3"], at: Float[np.ndarray, "m"]
) -> tuple[Float[np.ndarray, "m 3"], Bool[np.ndarray, "m"]]:
    """(values at other instants, where two near ones hold them)."""
    if len(t) < 2:
        return np.zeros((len(at), 3)), np.zeros(len(at), dtype=bool)
    k, near = _held(t, at)
    s = ((at - t[k]) / (t[k + 1] - t[k]))[:, None]
    return (1.0 - s) * values[k] + s * values[k + 1], near


def _slerped(
    t: Float[np.ndarray, "n"], q: Float[np.ndarray, "n wxyz=4"], at: Float[np.ndarray, "m"]
) -> tuple[Float[np.ndarray, "m wxyz=4"], Bool[np.ndarray, "m"]]:
    if len(t) < 2:
        return np.tile([1.0, 0.0, 0.0, 0.0], (len(at), 1)), np.zeros(len(at), dtype=bool)
    k, near = _held(t, at)
    return quaternion.slerp(q[k], q[k + 1], (at - t[k]) / (t[k + 1] - t[k])), near


def _held(t: Float[np.ndarray, "n"], at: Float[np.ndarray, "m"]) -> tuple[np.ndarray, Bool[np.ndarray, "m"]]:
    k = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
    gap = t[k + 1] - t[k]
    slack = 1e-9
    return k, (gap <= LONGEST_GAP_S) & (at >= t[k] - slack) & (at <= t[k + 1] + slack)


def _of(kind: type[_R], readings: Sequence[Reading], first: float, last: float) -> list[_R]:
    found = {r.t: r for r in readings if isinstance(r, kind) and first <= r.t <= last}
    return [found[t] for t in sorted(found)]


def _column(rows: Sequence[object], *shape: int) -> np.ndarray:
    return np.array(rows, dtype=np.float64).reshape(len(rows), *shape)
