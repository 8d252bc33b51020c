"""How the two craft turn: attitude errors that control holds in bounds, and free tumbling by Euler's equations."""

from dataclasses import dataclass

import numpy as np
import scipy
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.geometry.types import QuatWxyz, Vector3

DAMPING = 0.7
"""Damping of the control loop, as it is designed: fast without much overshoot."""
_Q, _W = slice(0, 4), slice(4, 7)
"""Places of attitude and rate in the state of a free body."""


@dataclass(frozen=True)
class WobbleConfig:
    """An attitude error about a commanded attitude, as a controlled craft shows it: second-order, random."""

    sigma_deg: float
    """Standard deviation per axis."""
    period_s: float
    """Natural period of the control loop."""

    @property
    def rate_density(self) -> float:
        """Random walk of the rate [rad/s per sqrt(s)] that keeps the error at `sigma_deg`."""
        w0 = 2.0 * np.pi / self.period_s
        return float(np.deg2rad(self.sigma_deg) * np.sqrt(4.0 * DAMPING * w0**3))


def wobble(config: WobbleConfig, dt: float, count: int, rng: np.random.Generator) -> Float[np.ndarray, "count 3"]:
    """Rotation vectors [rad] of the error at `count` steps of `dt`: th'' = -2 z w0 th' - w0^2 th + white noise."""
    if config.sigma_deg == 0.0:
        return np.zeros((count, 3))
    w0 = 2.0 * np.pi / config.period_s
    settle = int(np.ceil(2.0 * config.period_s / dt))
    drive = rng.normal(size=(count + settle, 3)) * config.rate_density * dt**1.5
    keep = 1.0 - 2.0 * DAMPING * w0 * dt
    errors = np.asarray(scipy.signal.lfilter([1.0], [1.0, -(1.0 + keep - (w0 * dt) ** 2), keep], drive, axis=0))
    return errors[settle:]


def tumble(
    q_eci_target: QuatWxyz, rate: Vector3, inertia: tuple[float, float, float], t: Float[np.ndarray, "n"]
) -> Float[np.ndarray, "n wxyz=4"]:
    """Attitude of a free body from its first attitude and rate (body axes); `inertia` up to a common factor."""
    J = np.array(inertia)

    def rates(_: float, y: Float[np.ndarray, "7"]) -> Float[np.ndarray, "7"]:
        return np.concatenate([_half_product(y[_Q], y[_W]), euler_acceleration(y[_W], J)])

    found = scipy.integrate.solve_ivp(
        rates, (t[0], t[-1]), np.concatenate([q_eci_target, rate]), method="DOP853", rtol=1e-10, atol=1e-12, t_eval=t
    )
    return quaternion.normalize(found.y[_Q].T)


def euler_acceleration(w: Vector3, J: Float[np.ndarray, "3"]) -> Vector3:
    """wdot = J^-1 (J w x w) of a free body with principal axes along the body axes."""
    return np.cross(J * w, w) / J


def mean_rates(q_a_b: Float[np.ndarray, "n wxyz=4"], dt: float) -> Float[np.ndarray, "n 3"]:
    """Rate of b with respect to a in b's axes [rad/s], meaned over the step before each instant; the first repeats."""
    turns = quaternion.log(quaternion.multiply(quaternion.conjugate(q_a_b[:-1]), q_a_b[1:])) / dt
    return np.concatenate([turns[:1], turns])


def _half_product(q: QuatWxyz, w: Vector3) -> QuatWxyz:
    """Derivative of q that turns with w, body axes."""
    return 0.5 * quaternion.multiply(q, np.concatenate([[0.0], w]))
