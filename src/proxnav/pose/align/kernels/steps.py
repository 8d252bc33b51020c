"""One Gauss-Newton step from edges and prior together."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.pose.solve.kernels.refinement import perturb


@kernel
def offset_from(R0, t0, R, t, d):
    """d = (dt, dr) from (R0, t0) to (R, t): t - t0 and the rotation vector of R R0^T, which is below half a turn."""
    D = R @ R0.T
    s0, s1, s2 = 0.5 * (D[2, 1] - D[1, 2]), 0.5 * (D[0, 2] - D[2, 0]), 0.5 * (D[1, 0] - D[0, 1])
    sine = math.sqrt(s0 * s0 + s1 * s1 + s2 * s2)
    angle = math.atan2(sine, 0.5 * (D[0, 0] + D[1, 1] + D[2, 2] - 1.0))
    scale = angle / sine if sine > 1e-9 else 1.0
    d[0], d[1], d[2] = t[0] - t0[0], t[1] - t0[1], t[2] - t0[2]
    d[3], d[4], d[5] = scale * s0, scale * s1, scale * s2


@kernel
def take_step(R, t, H, g, weight, P0, R0, t0, prior_weight, information, R_out, t_out):
    """(weight H + prior_weight P0) step = weight g - prior_weight P0 d, d from the prior; fills the information too."""
    d = np.empty(6)
    offset_from(R0, t0, R, t, d)
    pull = weight * g - prior_weight * (P0 @ d)
    scale = np.empty(6)
    for i in range(6):
        scale[i] = 1.0 / math.sqrt(weight * H[i, i] + prior_weight * P0[i, i])
    A = np.empty((6, 6))
    for i in range(6):
        for j in range(6):
            information[i, j] = weight * H[i, j] + prior_weight * P0[i, j]
            A[i, j] = scale[i] * scale[j] * information[i, j]
    perturb(R, t, scale * np.linalg.solve(A, scale * pull), R_out, t_out)
