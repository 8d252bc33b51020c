"""How a target turns that somebody controls: its attitude is pulled back to what is wanted."""

from typing import NamedTuple

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.rotations import log_matrix, multiply, to_matrix
from proxnav.navigation.layout import X


class ControlRows(NamedTuple):
    """Rows of the array (5, 3) that says how a target is controlled; zeros for a free one."""

    R_eci_wanted: slice
    """Attitude that control holds."""
    rate: int
    """Its inertial rate in its own axes [rad/s]."""
    loop: int
    """Natural frequency [rad/s] and damping of the control loop."""


CONTROL = ControlRows(slice(0, 3), 3, 4)


@kernel
def control_loop(control):
    """(natural frequency w0 [rad/s], damping zeta); w0 is zero for a free target."""
    return control[CONTROL.loop, 0], control[CONTROL.loop, 1]


@kernel
def control_error(x, control):
    """(error of a controlled target's attitude [rad], wanted rate [rad/s]), both in target axes."""
    R = np.ascontiguousarray(control[CONTROL.R_eci_wanted]).T @ to_matrix(multiply(x[X.q_eci_cam], x[X.q_cam_target]))
    return log_matrix(R), R.T @ np.ascontiguousarray(control[CONTROL.rate])


@kernel
def control_acceleration(x, control):
    """Angular acceleration of a controlled target, target axes [rad/s^2]: w0^2 and 2 zeta w0 pull it back."""
    error, wanted = control_error(x, control)
    w0, zeta = control_loop(control)
    excess = x[X.rate] - wanted
    return -w0 * w0 * error - 2.0 * zeta * w0 * excess + np.cross(wanted, excess)
