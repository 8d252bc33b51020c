"""A window of readings with what every test needs of it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.geometry.types import QuatWxyz, Rotation3x3, Vector3
from proxnav.navigation.filter_setup import FilterSetup
from proxnav.navigation.monitor.conventions import READINGS_OF_QUATERNIONS, Convention
from proxnav.navigation.monitor.window import Window, interpolated

_LEAST_PAIR_S, _LONGEST_PAIR_S = 2.0, 15.0
"""Between two fixes whose turn the gyro is compared with."""


class PoseConvention(NamedTuple):
    """Another meaning of the poses in a file."""

    name: str
    read: Callable[[QuatWxyz, Vector3], tuple[QuatWxyz, Vector3]]


def _with_position(convention: Convention) -> PoseConvention:
    return PoseConvention(convention.name, lambda q, t: (convention.read(q), t))


def _inverse(q: QuatWxyz, t: Vector3) -> tuple[QuatWxyz, Vector3]:
    back = quaternion.conjugate(q)
    return back, -quaternion.rotate(back, t)


READINGS_OF_POSES = (
    *(_with_position(c) for c in READINGS_OF_QUATERNIONS),
    PoseConvention("those of T_target_cam, the inverse", _inverse),
)


@dataclass(frozen=True, slots=True, eq=False)
class Pairs:
    """Pairs of star tracker fixes, and what the gyro says between them."""

    t: Float[np.ndarray, "n"]
    span: Float[np.ndarray, "n"]
    q_first: QuatWxyz
    q_last: QuatWxyz
    sigma: Float[np.ndarray, "n 3"]
    turned: Float[np.ndarray, "n 3"]
    """Integral of the gyro's rates [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class Sightings:
    """Poses at instants of which the star tracker's attitude and the GNSS baseline are known too."""

    t: Float[np.ndarray, "n"]
    q_star: QuatWxyz
    q_pose: QuatWxyz
    position: Float[np.ndarray, "n 3"]
    covariance: Float[np.ndarray, "n 6 6"]
    baseline: Float[np.ndarray, "n 3"]
    gnss_sigma: float
    R_eci_ric: Rotation3x3


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A window, ready for the tests."""

    window: Window
    setup: FilterSetup
    pairs: Pairs | None
    with_gnss: Sightings | None
    with_star: Sightings | None


def scene_of(window: Window, setup: FilterSetup) -> Scene:
    """Samples of the window, by what they can be compared with."""
    return Scene(window, setup, _pairs(window), _sightings(window, setup, True), _sightings(window, setup, False))


def _pairs(window: Window) -> Pairs | None:
    if len(window.gyro_t) < 4 or len(window.star_t) < 4:
        return None
    rows, first = [], 0
    for k in range(1, len(window.star_t)):
        a, b = window.star_t[first], window.star_t[k]
        if b - a < _LEAST_PAIR_S:
            continue
        if b - a < _LONGEST_PAIR_S and window.gyro_covers(a, b):
            rows.append((first, k))
        first = k
    if not rows:
        return None
    i, j = np.array(rows).T
    a, b = window.star_t[i], window.star_t[j]
    sigma = np.hypot(window.star_sigma[i], window.star_sigma[j])
    return Pairs(
        0.5 * (a + b), b - a, window.q_star[i], window.q_star[j], sigma, window.turned(b) - window.turned(a)
    )  # fmt: skip


def _sightings(window: Window, setup: FilterSetup, needs_gnss: bool) -> Sightings | None:
    t = window.pose_t
    q_star, has_star = window.attitude(t)
    baseline, has_gnss = interpolated(window.gnss_t, window.baseline, t)
    keep = has_star & has_gnss if needs_gnss else has_star
    if not keep.any():
        return None
    axes = np.array([setup.R_eci_ric(float(at)) for at in t[keep]])
    sigma = float(np.median(window.gnss_sigma)) if len(window.gnss_sigma) else 0.0
    return Sightings(
        t[keep], q_star[keep], window.q_pose[keep], window.position[keep], window.covariance[keep], baseline[keep],
        sigma, axes,
    )  # fmt: skip
