"""One Gauss-Newton step from edges and prior together."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.perturbation import difference, moved


@kernel
def take_step(R, t, H, g, weight, P0, R0, t0, prior_weight, information, R_out, t_out):
    """(weight H + prior_weight P0) step = weight g - prior_weight P0 d, d from the prior; fills the information too."""
    d = np.empty(6)
    difference(R0, t0, R, t, d)
    pull = weight * g - prior_weight * (P0 @ d)
    scale = np.empty(6)
    for i in range(6):
        scale[i] = 1.0 / math.sqrt(weight * H[i, i] + prior_weight * P0[i, i])
    A = np.empty((6, 6))
    for i in range(6):
        for j in range(6):
            information[i, j] = weight * H[i, j] + prior_weight * P0[i, j]
            A[i, j] = scale[i] * scale[j] * information[i, j]
    moved(R, t, scale * np.linalg.solve(A, scale * pull), R_out, t_out)
