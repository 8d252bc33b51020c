"""Relative motion about an eccentric orbit, in RIC: x radial outward, y in-track, z along the orbit's normal.

K. Yamanaka, F. Ankersen, "New state transition matrix for relative motion on an arbitrary elliptical orbit",
J. Guidance, Control, and Dynamics 25(1), 2002. The paper's axes are x along-track, y against the normal, z to nadir.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry.celestial import MU_EARTH
from proxnav.geometry.types import Vector3

Matrix6 = Float[np.ndarray, "6 6"]

_RIC_FROM_PAPER = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
_BOTH = np.kron(np.eye(2), _RIC_FROM_PAPER)


@dataclass(frozen=True)
class ReferenceOrbit:
    """The target's Keplerian orbit as far as relative motion needs it."""

    semi_latus_rectum_m: float
    eccentricity: float
    true_anomaly: float
    """At the instant of the state [rad]."""

    @property
    def angular_momentum(self) -> float:
        """h [m^2/s]."""
        return float(np.sqrt(MU_EARTH * self.semi_latus_rectum_m))

    @property
    def mean_motion(self) -> float:
        """n [rad/s]."""
        a = self.semi_latus_rectum_m / (1.0 - self.eccentricity**2)
        return float(np.sqrt(MU_EARTH / a**3))

    def true_anomaly_after(self, dt: float) -> float:
        """True anomaly [rad] `dt` seconds later, by Kepler's equation."""
        e = self.eccentricity
        E = 2.0 * np.arctan2(
            np.sqrt(1 - e) * np.sin(0.5 * self.true_anomaly), np.sqrt(1 + e) * np.cos(0.5 * self.true_anomaly)
        )
        M = E - e * np.sin(E) + self.mean_motion * dt
        E = solve_kepler(M, e)
        return float(E + 2.0 * np.arctan2(e * np.sin(E), 1.0 + np.sqrt(1.0 - e * e) - e * np.cos(E)))


def reference_orbit(r_eci_m: Vector3, v_eci_mps: Vector3) -> ReferenceOrbit:
    """Osculating orbit of one state in ECI. InputError when it is not an ellipse."""
    h = np.cross(r_eci_m, v_eci_mps)
    radius = np.linalg.norm(r_eci_m)
    towards_perigee = np.cross(v_eci_mps, h) / MU_EARTH - r_eci_m / radius
    e = float(np.linalg.norm(towards_perigee))
    if not e < 1.0:
        raise InputError(
            f"the target's orbit needs an eccentricity below 1, found {e:.4g}: check position and velocity"
        )
    p = float(h @ h) / MU_EARTH
    # From r = p / (1 + e cos th) and rdot = sqrt(mu/p) e sin th: defined for circles too, where perigee is anywhere.
    radial_speed = float(r_eci_m @ v_eci_mps) / radius
    theta = np.arctan2(radial_speed * np.sqrt(p / MU_EARTH), p / radius - 1.0)
    return ReferenceOrbit(p, e, float(theta))


def solve_kepler(M: float, e: float) -> float:
    """Eccentric anomaly [rad] of the mean anomaly M [rad], whole turns kept."""
    E = M + e * np.sin(M)
    for _ in range(30):
        step = (E - e * np.sin(E) - M) / (1.0 - e * np.cos(E))
        E -= step
        if abs(step) < 1e-15 * max(1.0, abs(E)):
            break
    return float(E)


def ya_transition(orbit: ReferenceOrbit, dt: float) -> Matrix6:
    """Phi with (rho, rho_dot)(t + dt) = Phi (rho, rho_dot)(t) in RIC, for any eccentricity below 1."""
    after = orbit.true_anomaly_after(dt)
    k2 = orbit.angular_momentum / orbit.semi_latus_rectum_m**2
    scaled = _propagate(orbit.eccentricity, after, k2 * dt) @ _constants(orbit.eccentricity, orbit.true_anomaly)
    scaled[np.ix_([1, 4], [1, 4])] = _turn(after - orbit.true_anomaly)
    paper = (
        _from_scaled(orbit.eccentricity, after, k2) @ scaled @ _to_scaled(orbit.eccentricity, orbit.true_anomaly, k2)
    )
    return _BOTH @ paper @ _BOTH.T


_PLANE = np.ix_([0, 2, 3, 5], [0, 2, 3, 5])


def _constants(e: float, th: float) -> Matrix6:
    """Integration constants of the in-plane motion from the scaled state (eq. 82 with its pseudo-initial values)."""
    rho = 1.0 + e * np.cos(th)
    s, c = rho * np.sin(th), rho * np.cos(th)
    b = np.zeros((6, 6))
    b[_PLANE] = np.array(
        [
            [1 - e * e, 3 * e * s * (1 / rho + 1 / rho**2), -e * s * (1 + 1 / rho), -e * c + 2],
            [0, -3 * s * (1 / rho + e * e / rho**2), s * (1 + 1 / rho), c - 2 * e],
            [0, -3 * (c / rho + e), c * (1 + 1 / rho) + e, -s],
            [0, 3 * rho + e * e - 1, -(rho**2), e * s],
        ]
    ) / (1 - e * e)
    return b


def _propagate(e: float, th: float, J: float) -> Matrix6:
    """The scaled in-plane state at `th` from the integration constants (eq. 73)."""
    rho = 1.0 + e * np.cos(th)
    s, c = rho * np.sin(th), rho * np.cos(th)
    ds, dc = np.cos(th) + e * np.cos(2 * th), -(np.sin(th) + e * np.sin(2 * th))
    out = np.zeros((6, 6))
    out[_PLANE] = np.array(
        [
            [1, -c * (1 + 1 / rho), s * (1 + 1 / rho), 3 * rho**2 * J],
            [0, s, c, 2 - 3 * e * s * J],
            [0, 2 * s, 2 * c - e, 3 * (1 - 2 * e * s * J)],
            [0, ds, dc, -3 * e * (ds * J + s / rho**2)],
        ]
    )
    return out


def _turn(angle: float) -> Float[np.ndarray, "2 2"]:
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def _to_scaled(e: float, th: float, k2: float) -> Matrix6:
    rho, eye = 1.0 + e * np.cos(th), np.eye(3)
    return np.block([[rho * eye, 0 * eye], [-e * np.sin(th) * eye, eye / (k2 * rho)]])


def _from_scaled(e: float, th: float, k2: float) -> Matrix6:
    rho, eye = 1.0 + e * np.cos(th), np.eye(3)
    return np.block([[eye / rho, 0 * eye], [k2 * e * np.sin(th) * eye, k2 * rho * eye]])
