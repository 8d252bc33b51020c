"""Relative orbital elements of near-circular orbits, and how near two craft can come if nobody acts.

S. D'Amico, "Autonomous formation flying in low Earth orbit", PhD thesis, TU Delft, 2010. Positions in RIC.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry.celestial import EARTH_EQUATORIAL_RADIUS, EARTH_J2, MU_EARTH
from proxnav.geometry.types import Vector3


@dataclass(frozen=True)
class Elements:
    """Near-circular elements of one craft: argument of latitude u = omega + M, eccentricity vector (ex, ey)."""

    a_m: float
    u: float
    """Mean argument of latitude [rad]."""
    ex: float
    ey: float
    i: float
    """Inclination [rad]."""
    raan: float
    """[rad]."""


@dataclass(frozen=True)
class RelativeElements:
    """Quasi-nonsingular relative elements, all dimensionless: times `a` they are lengths."""

    da: float
    dlambda: float
    dex: float
    dey: float
    dix: float
    diy: float

    @property
    def vector(self) -> Float[np.ndarray, "6"]:
        """(da, dlambda, dex, dey, dix, diy)."""
        return np.array([self.da, self.dlambda, self.dex, self.dey, self.dix, self.diy])


def elements(r_eci_m: Vector3, v_eci_mps: Vector3) -> Elements:
    """Osculating elements of one state in ECI."""
    h = np.cross(r_eci_m, v_eci_mps)
    radius = float(np.linalg.norm(r_eci_m))
    a = 1.0 / (2.0 / radius - float(v_eci_mps @ v_eci_mps) / MU_EARTH)
    i = float(np.arctan2(np.hypot(h[0], h[1]), h[2]))
    raan = float(np.arctan2(h[0], -h[1]))
    node = np.array([np.cos(raan), np.sin(raan), 0.0])
    ahead = np.cross(h / np.linalg.norm(h), node)
    e_vec = np.cross(v_eci_mps, h) / MU_EARTH - r_eci_m / radius
    ex, ey = float(e_vec @ node), float(e_vec @ ahead)
    true_latitude = float(np.arctan2(r_eci_m @ ahead, r_eci_m @ node))
    return Elements(a, _mean_latitude(true_latitude, ex, ey), ex, ey, i, raan)


def relative_elements(target: Elements, chaser: Elements) -> RelativeElements:
    """Elements of the chaser relative to the target (D'Amico, eq. 2.2)."""
    d_raan = _wrap(chaser.raan - target.raan)
    return RelativeElements(
        da=(chaser.a_m - target.a_m) / target.a_m,
        dlambda=_wrap(chaser.u - target.u) + d_raan * np.cos(target.i),
        dex=chaser.ex - target.ex,
        dey=chaser.ey - target.ey,
        dix=chaser.i - target.i,
        diy=d_raan * np.sin(target.i),
    )


def relative_position(
    roe: RelativeElements, a_m: float, u: Float[np.ndarray, "*n"], u0: float
) -> Float[np.ndarray, "*n 3"]:
    """Position in RIC [m] at argument of latitude `u`, from the elements at `u0` (D'Amico, eq. 2.17), two-body."""
    along = u - u0
    x = roe.da - roe.dex * np.cos(u) - roe.dey * np.sin(u)
    y = roe.dlambda - 1.5 * roe.da * along + 2.0 * roe.dex * np.sin(u) - 2.0 * roe.dey * np.cos(u)
    z = roe.dix * np.sin(u) - roe.diy * np.cos(u)
    return a_m * np.stack([x, y, z], axis=-1)


def passive_safety_m(roe: RelativeElements, a_m: float) -> float:
    """Least distance [m] to the target across the flight direction, over a revolution: what remains if control fails.

    The path across the flight is x = da - |de| cos(u - phi), z = |di| sin(u - theta); with da = 0 an ellipse about the
    target. Found numerically, so that da may differ from zero.
    """
    u = np.linspace(0.0, 2.0 * np.pi, 3601)
    across = relative_position(RelativeElements(roe.da, 0.0, roe.dex, roe.dey, roe.dix, roe.diy), a_m, u, 0.0)
    return float(np.hypot(across[:, 0], across[:, 2]).min())


def passive_safety_closed_m(roe: RelativeElements, a_m: float) -> float:
    """The same in closed form for da = 0: the smaller semi-axis of the ellipse across the flight.

    x = -de . (cos u, sin u), z = di . (sin u, -cos u): the smaller singular value of that 2x2 map.
    """
    across = np.array([[-roe.dex, -roe.dey], [-roe.diy, roe.dix]])
    return a_m * float(np.linalg.svd(across, compute_uv=False)[1])


def drift_under_j2(roe: RelativeElements, a_m: float, i: float, du: float) -> RelativeElements:
    """Elements after `du` radians of argument of latitude under J2, to first order (D'Amico, eq. 2.30)."""
    gamma = 0.5 * EARTH_J2 * (EARTH_EQUATORIAL_RADIUS / a_m) ** 2
    turn = 1.5 * gamma * (5.0 * np.cos(i) ** 2 - 1.0) * du
    c, s = np.cos(turn), np.sin(turn)
    return RelativeElements(
        da=roe.da,
        dlambda=roe.dlambda - (1.5 * roe.da + 10.5 * gamma * np.sin(2.0 * i) * roe.dix) * du,
        dex=c * roe.dex - s * roe.dey,
        dey=s * roe.dex + c * roe.dey,
        dix=roe.dix,
        diy=roe.diy + 3.0 * gamma * np.sin(i) ** 2 * roe.dix * du,
    )


def _mean_latitude(true_latitude: float, ex: float, ey: float) -> float:
    """omega + M from omega + true anomaly."""
    e = float(np.hypot(ex, ey))
    omega = float(np.arctan2(ey, ex)) if e > 0.0 else 0.0
    nu = true_latitude - omega
    E = float(np.arctan2(np.sqrt(1.0 - e * e) * np.sin(nu), e + np.cos(nu)))
    return omega + E - e * float(np.sin(E))


def _wrap(angle: float) -> float:
    return float((angle + np.pi) % (2.0 * np.pi) - np.pi)
