"""Gyro against star tracker: turns between fixes, under every permutation and sign of axes and other conventions."""

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.geometry.types import QuatWxyz
from proxnav.navigation.filter_setup import FilterSetup
from proxnav.navigation.monitor.account import AGREES, NOT_COMPARED, Account, unexplained
from proxnav.navigation.monitor.conventions import AS_ASKED, SIGNED_AXES, Convention, signed_axes
from proxnav.navigation.monitor.evidence import CLEARLY, Fit, Noise, fit
from proxnav.navigation.monitor.scene import Pairs, Scene

KIND = "gyro against star tracker"
_MISALIGNED = 0.02
"""Share of a turn by which an honest gyro may err: scale and mounting to a degree."""
_AXES = [
    f"gyro and star tracker disagree by a permutation or sign of axes: the camera's axes are {name} of the gyro's"
    for name, _ in signed_axes()
]
_OTHERS = (
    "the gyro's rates look as if in degrees per second, not radians",
    "the gyro's rates look relative to the orbital frame, not inertial",
    "the gyro's rates look given in ECI axes, not the camera's",
)
CAUSES = ("", *_AXES[1:], *_OTHERS)
_MOST_NAMED = 3
_MOST_BIAS = 3e-3
"""A bias that a gyro may come to have in flight [rad/s]: 600 deg/h."""
BIAS = "gyro and star tracker differ by a constant rate of {:.0f} deg/h, more than --filter.noise.gyro-bias allows for"


def gyro_account(scene: Scene, star: Convention, excluded: frozenset[int]) -> Account:
    """What the gyro says where the star tracker's quaternions have a convention; `excluded`: causes of no account."""
    found = gyro_fit(scene, star)
    if found is None:
        return NOT_COMPARED
    if not found.refuted():
        return Account(chi2=float(found.chi2[0]))
    best = float(found.chi2[1:].min())
    fits = [k for k in range(1, len(CAUSES)) if found.fits(k) and k not in excluded and found.chi2[k] < best + CLEARLY]
    if fits and found.chi2[0] > best + CLEARLY:
        fits.sort(key=lambda k: (found.chi2[k] > best + 0.5 * CLEARLY, k < len(SIGNED_AXES), found.chi2[k]))
        return Account(1.0, KIND, _named(fits), chi2=float(found.chi2[fits[0]]))
    return _constant(scene, star, bool(excluded) and star is AS_ASKED)


def gyro_fit(scene: Scene, star: Convention) -> Fit | None:
    """Chi-square of each of `CAUSES`."""
    pairs = scene.pairs
    if pairs is None:
        return None
    seen, predicted = _turns(pairs, star, scene.setup)
    return fit(pairs.t, seen - predicted, _noise(pairs, scene.setup.config.noise.gyro_bias, scene.setup))


def _turns(
    pairs: Pairs, star: Convention, setup: FilterSetup
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "h n 3"]]:
    """(turns by the star tracker, turns by the gyro under each hypothesis), camera axes [rad]."""
    q0, q1 = star.read(pairs.q_first), star.read(pairs.q_last)
    seen, g = _turn(q0, q1), pairs.turned
    to_cam = quaternion.conjugate(q0)
    orbital = np.array([setup.R_eci_ric(float(t))[:, 2] * setup.orbit(float(t))[3] for t in pairs.t])
    others = [
        g * np.pi / 180.0, g + quaternion.rotate(to_cam, orbital) * pairs.span[:, None], quaternion.rotate(to_cam, g)
    ]  # fmt: skip
    return seen, np.concatenate([np.einsum("hij,nj->hni", SIGNED_AXES, g), np.array(others)])


def _turn(q0: QuatWxyz, q1: QuatWxyz) -> Float[np.ndarray, "n 3"]:
    return quaternion.log(quaternion.multiply(quaternion.conjugate(q0), q1))


def _noise(pairs: Pairs, bias: float, setup: FilterSetup) -> Noise:
    size = np.minimum(np.linalg.norm(pairs.turned, axis=1), 1.0)[:, None]
    span = pairs.span[:, None]
    white = pairs.sigma**2 + setup.config.noise.gyro**2 * span + (0.5 * _MISALIGNED * size) ** 2
    constant = (bias * np.median(span)) ** 2 + (_MISALIGNED * np.median(size)) ** 2
    return Noise(white, np.full(3, constant))


def _constant(scene: Scene, star: Convention, is_known_good: bool) -> Account:
    """A bias that nobody expected, or a contradiction without a name."""
    pairs = scene.pairs
    assert pairs is not None
    seen, predicted = _turns(pairs, star, scene.setup)
    residuals = seen - predicted[0]
    rates = np.linalg.norm(residuals / pairs.span[:, None], axis=1)
    if is_known_good and np.median(rates) < _MOST_BIAS:  # axes were right before: the filter learns a bias
        return AGREES
    loose = fit(pairs.t, residuals[None], _noise(pairs, 0.1, scene.setup))
    if loose is None or not loose.fits(0):
        return unexplained(KIND, "gyro and star tracker contradict each other, and no convention of axes explains it")
    rate = np.median(residuals / pairs.span[:, None], axis=0)
    return Account(1.4, KIND, BIAS.format(np.rad2deg(np.linalg.norm(rate)) * 3600.0))


def _named(fits: list[int]) -> str:
    """The best, and others that this turn does not tell apart."""
    if len(fits) == 1 or fits[0] >= len(SIGNED_AXES):
        return CAUSES[fits[0]]
    names = [CAUSES[k].split(" are ")[-1].removesuffix(" of the gyro's") for k in fits[1:] if k < len(SIGNED_AXES)]
    others = f"{', '.join(names[:_MOST_NAMED])}{' and others' if len(names) > _MOST_NAMED else ''}"
    return f"{CAUSES[fits[0]]} (or {others}, which this motion does not tell apart)" if names else CAUSES[fits[0]]
