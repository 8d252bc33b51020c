"""From one state to another by an error vector, and back."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.rotations import conjugate, exp, multiply, skew
from proxnav.navigation.layout import E, X


@kernel
def corrected(x, e):
    """State x moved by the error vector e."""
    y = np.empty(len(x))
    y[X.motion] = x[X.motion] + e[E.motion]
    y[X.q_eci_cam] = multiply(x[X.q_eci_cam], exp(e[E.attitude_cam]))
    y[X.q_cam_target] = multiply(x[X.q_cam_target], exp(e[E.attitude]))
    y[X.vectors] = x[X.vectors] + e[E.vectors]
    return y


@kernel
def relative_error(x, y):
    """The error vector that leads from state x to state y."""
    e = np.empty(len(x) - 2)
    e[E.motion] = y[X.motion] - x[X.motion]
    e[E.attitude_cam] = 2.0 * _half_log(x[X.q_eci_cam], y[X.q_eci_cam])
    e[E.attitude] = 2.0 * _half_log(x[X.q_cam_target], y[X.q_cam_target])
    e[E.vectors] = y[X.vectors] - x[X.vectors]
    return e


@kernel
def reset(P, e):
    """P about the corrected attitude: G P G^T with G = I - [e/2]x for both attitudes."""
    out = P.copy()
    for block in (E.attitude_cam, E.attitude):
        G = np.eye(3) - 0.5 * skew(e[block])
        out[block, :] = G @ np.ascontiguousarray(out[block, :])
        out[:, block] = np.ascontiguousarray(out[:, block]) @ G.T
    return 0.5 * (out + out.T)


@kernel
def _half_log(p, q):
    step = multiply(conjugate(p), q)
    sign = -1.0 if step[0] < 0.0 else 1.0
    sine = math.sqrt(step[1] ** 2 + step[2] ** 2 + step[3] ** 2)
    scale = 1.0 if sine < 1e-9 else math.atan2(sine, sign * step[0]) / sine
    return sign * scale * step[1:]
