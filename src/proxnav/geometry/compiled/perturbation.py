"""Small steps between poses for compiled code, as in proxnav.geometry.perturbation: (dt, dr), t + dt, exp(dr) R.

DT and DR are the places of their first components in a step of six: translation [m] and rotation [rad], camera axes.
"""

import math

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.rotations import log_matrix
from proxnav.geometry.compiled.vectors import cross, dot, minus, put, triple

DT, DR = 0, 3


@kernel
def difference(R0, t0, R, t, step):
    """Fills the step from (R0, t0) to (R, t), which turns by less than half a turn."""
    put(step, DT, minus(t, t0))
    put(step, DR, log_matrix(R @ R0.T))


@kernel
def moved(R, t, step, R_out, t_out):
    """Fills the pose after a step, by the formula of Rodrigues."""
    dr = triple(step, DR)
    angle2 = dot(dr, dr)
    angle = math.sqrt(angle2)
    s = math.sin(angle) / angle if angle > 1e-8 else 1.0
    h = (1.0 - math.cos(angle)) / angle2 if angle > 1e-4 else 0.5 - angle2 / 24.0
    for k in range(3):
        column = (R[0, k], R[1, k], R[2, k])
        once = cross(dr, column)
        twice = cross(dr, once)
        for i in range(3):
            R_out[i, k] = column[i] + s * once[i] + h * twice[i]
        t_out[k] = t[k] + step[DT + k]


@kernel
def step_gradient(a, b, x, y, p):
    """Derivatives by (dt, dr) of an image coordinate of the point R X + t, whose place on the plane z = 1 is (x, y).

    `a` and `b` are its derivatives by x and y over the depth; `p` is R X, camera axes [m].
    """
    g = (a, b, -(a * x + b * y))
    turn = cross(p, g)
    return g[0], g[1], g[2], turn[0], turn[1], turn[2]
