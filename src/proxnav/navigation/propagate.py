"""Belief forward in time, with the gyro's rates and the accelerometer's burns."""

from dataclasses import dataclass, replace

import numpy as np

from proxnav.geometry import quaternion
from proxnav.navigation.belief import Belief, Scene
from proxnav.navigation.kernels.prediction import ANGLE_VAR, RATE_PSD, advance
from proxnav.navigation.kernels.relative import gradient_transition

_LONGEST_S = 2.0
_GAP_S = 2.5
"""Gyro readings older than this are stale: the camera's rate may have changed meanwhile."""
_FREE_FORCES = 200
"""Coasting readings after which the accelerometer's bias is a running mean."""

_NONE = np.zeros(3)


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """One prediction, kept for the smoother: error after = blockdiag(F, diag(d)) error before + noise."""

    F: np.ndarray
    d: np.ndarray


def propagate(belief: Belief, t: float, scene: Scene, steps: list[Step] | None = None) -> Belief:
    """The belief at `t`, not before its own time. Long gaps go in pieces; `steps` collects the transitions."""
    while belief.t < t:
        belief = _step(belief, min(t, belief.t + _LONGEST_S), scene, steps)
    return belief


def take_gyro(belief: Belief, t: float, rate: np.ndarray, scene: Scene, steps: list[Step] | None = None) -> Belief:
    """To `t` with the mean rate over the time since the last reading."""
    if belief.t < t and t - belief.t > _LONGEST_S:
        belief = propagate(belief, t - 1e-3, scene, steps)  # readings are missing: the new rate holds for its end only
    belief = replace(belief, rate_cam=rate, gyro_t=t)
    return propagate(belief, t, scene, steps)


def take_force(
    belief: Belief, t: float, reading: tuple[np.ndarray, float, float], scene: Scene, steps: list[Step] | None = None
) -> Belief:
    """To `t`; in a burn with the velocity that it gave, else the reading teaches the bias.

    `reading`: specific force [m/s^2] in camera axes, thruster state (1, 0, -1), time that it covers.
    """
    force, thrust, dt = reading
    belief = propagate(belief, t, scene, steps)
    always = scene.config.accelerometer == "always"
    felt = force if always else force - belief.force_bias
    burning = thrust > 0.5 or (thrust < 0.0 and np.linalg.norm(felt) > scene.config.burn_threshold_mps2)
    if not (burning or always):
        count = min(belief.force_count + 1, _FREE_FORCES * 10)
        bias = belief.force_bias + (force - belief.force_bias) / count
        return replace(belief, force_bias=bias, force_count=count)
    return belief if belief.x is None else _kick(belief, felt * dt, dt, scene)


def _kick(belief: Belief, dv_cam: np.ndarray, dt: float, scene: Scene) -> Belief:
    """Velocity gained in one reading, camera axes; half a reading's worth of way goes with it."""
    assert belief.x is not None
    assert belief.P is not None
    R_ric_cam = scene.orbit(belief.t)[2].T @ quaternion.to_matrix(belief.x[6:10])
    dv = R_ric_cam @ dv_cam
    noise = scene.config.noise
    variance = noise.accelerometer**2 * dt + noise.burn_share**2 * float(dv @ dv)
    x, P = belief.x.copy(), belief.P.copy()
    x[3:6] += dv
    x[:3] += 0.5 * dt * dv
    P[range(3, 6), range(3, 6)] += variance
    P[range(3), range(3)] += 0.25 * dt * dt * (variance + float(dv @ dv))
    return replace(belief, x=x, P=P)


def _step(belief: Belief, t: float, scene: Scene, steps: list[Step] | None) -> Belief:
    if belief.x is None or belief.P is None:
        return replace(belief, t=t)
    dt = t - belief.t
    noise = scene.noise.copy()
    if scene.has_gyro and t - belief.gyro_t > _GAP_S:
        noise[ANGLE_VAR] = (scene.config.noise.held_rate * dt) ** 2 + scene.config.noise.held_rate**2 * dt
    if scene.inertia[0] > 0.0:
        noise[RATE_PSD] += _inertia_psd(belief.x[14:17], scene.config.inertia_sigma)
    rate = belief.rate_cam if scene.has_gyro else _NONE
    Phi, held = gradient_transition(*scene.ephemeris, belief.t, dt), scene.held(belief.t)
    x, P, F, d = advance(belief.x, belief.P, Phi, dt, rate, scene.inertia, held, belief.pose_errors, noise)
    if steps is not None:
        steps.append(Step(F, d))
    return replace(belief, t=t, x=x, P=P)


def _inertia_psd(rate: np.ndarray, sigma: float) -> float:
    """Of the angular acceleration that wrong moments leave out: sigma w^2, which turns with the body at about w."""
    return sigma**2 * float(np.linalg.norm(rate)) ** 3
