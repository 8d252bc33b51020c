"""From one state to another by an error vector, and back."""

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.rotations import conjugate, exp, log, multiply, skew
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
    e[E.attitude_cam] = log(multiply(conjugate(x[X.q_eci_cam]), y[X.q_eci_cam]))
    e[E.attitude] = log(multiply(conjugate(x[X.q_cam_target]), y[X.q_cam_target]))
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
