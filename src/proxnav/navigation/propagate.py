"""Belief forward in time, with the gyro's rates and the accelerometer's burns."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.geometry.types import Vector3
from proxnav.navigation.belief import Belief, Tracking, Waiting, camera_rate
from proxnav.navigation.filter_setup import FilterSetup
from proxnav.navigation.kernels.dynamics import advance
from proxnav.navigation.kernels.gravity_gradient import gradient_transition
from proxnav.navigation.layout import E, X, diagonal
from proxnav.navigation.learnt_noise import memory_s, taught_by_motion
from proxnav.navigation.process_noise import ANGLE_VAR, CAMERA_TAU, SLOW_VARIANCE, TURN_SHARE
from proxnav.navigation.readings import Acceleration, GyroReading

_LONGEST_S = 2.0
_GAP_S = 2.5
"""Gyro readings older than this are stale: the camera's rate may have changed meanwhile."""
_STALE_RATE = 3e-4
"""How wrong the last rate may be where gyro readings are missing [rad/s]."""
_FREE_FORCES = 200
"""Coasting readings after which the accelerometer's bias is a running mean."""
_BURN_MPS2 = 0.02
"""Specific force of a burn, where nobody tells of thrusters: 2 mg, far above the accelerometer's noise and bias."""
_BURN_SHARE = 2e-3
"""Scale and alignment errors of a burn, as a share of it."""


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """One prediction, kept for the smoother: error after = blockdiag(F, diag(d)) error before + noise."""

    F: Float[np.ndarray, "n_core n_core"]
    d: Float[np.ndarray, "n_fading"]


def propagate(belief: Belief, t: float, setup: FilterSetup, steps: list[Step] | None = None) -> Belief:
    """The belief at `t`, not before its own time; `steps` collects the transitions of a state."""
    if isinstance(belief, Waiting):
        return replace(belief, t=max(t, belief.t))
    return predicted(belief, t, setup, steps)


def predicted(belief: Tracking, t: float, setup: FilterSetup, steps: list[Step] | None = None) -> Tracking:
    """The state at `t`, not before its own time. Long gaps go in pieces."""
    while belief.t < t:
        belief = _step(belief, min(t, belief.t + _LONGEST_S), setup, steps)
    return belief


def turned(belief: Belief, reading: GyroReading, setup: FilterSetup, steps: list[Step] | None = None) -> Belief:
    """To the beginning of the reading's step, and from there on with its rate."""
    belief = propagate(belief, reading.since, setup, steps)
    return replace(belief, memory=replace(belief.memory, gyro=reading))


def pushed(belief: Belief, reading: Acceleration, setup: FilterSetup, steps: list[Step] | None = None) -> Belief:
    """To the reading's time; in a burn with the velocity that it gave, else the reading teaches the bias."""
    belief = propagate(belief, reading.t, setup, steps)
    force, memory = reading.specific_force, belief.memory
    always = setup.config.accelerometer == "always"
    felt = force if always else force - memory.force_bias
    burning = reading.thrust > 0.5 or (reading.thrust < 0.0 and np.linalg.norm(felt) > _BURN_MPS2)
    if burning or always:
        return belief if isinstance(belief, Waiting) else _kicked(belief, felt * reading.step_s, reading.step_s, setup)
    count = min(memory.force_count + 1, _FREE_FORCES * 10)
    bias = memory.force_bias + (force - memory.force_bias) / count
    return replace(belief, memory=replace(memory, force_bias=bias, force_count=count))


def _kicked(belief: Tracking, dv_cam: Vector3, dt: float, setup: FilterSetup) -> Tracking:
    """With the velocity gained in one reading, camera axes; half a reading's worth of way goes with it."""
    R_ric_cam = setup.R_eci_ric(belief.t).T @ quaternion.to_matrix(belief.x[X.q_eci_cam])
    dv = R_ric_cam @ dv_cam
    square = float(dv @ dv)
    variance = setup.config.noise.accelerometer**2 * dt + _BURN_SHARE**2 * square
    x, P = belief.x.copy(), belief.P.copy()
    x[X.velocity] += dv
    x[X.position] += 0.5 * dt * dv
    P[diagonal(E.velocity)] += variance
    P[diagonal(E.position)] += 0.25 * dt * dt * (variance + square)
    return replace(belief, x=x, P=P)


def _step(belief: Tracking, t: float, setup: FilterSetup, steps: list[Step] | None) -> Tracking:
    dt, gyro = t - belief.t, belief.memory.gyro
    noise, memory = setup.noise.copy(), taught_by_motion(belief, dt, setup)
    noise[CAMERA_TAU] = memory_s(memory, setup)
    noise[SLOW_VARIANCE], noise[TURN_SHARE] = memory.slow_variance, memory.turn_factor * noise[TURN_SHARE]
    if setup.has_gyro and t - gyro.t > _GAP_S:
        noise[ANGLE_VAR] = (_STALE_RATE * dt) ** 2 + _STALE_RATE**2 * dt
    rate = camera_rate(belief, setup)
    Phi, control = gradient_transition(*setup.ephemeris, belief.t, dt), setup.control(belief.t)
    x, P, F, d = advance(belief.x, belief.P, Phi, dt, rate, setup.inertia, control, belief.pose_errors, noise)
    if steps is not None:
        steps.append(Step(F, d))
    return replace(belief, t=t, x=x, P=P, memory=memory)
