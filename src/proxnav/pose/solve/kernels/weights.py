"""What the covariances of pixels weigh: rows (UU, UV, VV) of the inverse [[UU, UV], [UV, VV]] of a 2x2 covariance."""

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.lens import distort
from proxnav.geometry.compiled.vectors import put

UU, UV, VV = range(3)


@kernel
def squared(info, eu, ev):
    """Squared Mahalanobis distance of an error (eu, ev)."""
    return eu * (info[UU] * eu + 2.0 * info[UV] * ev) + info[VV] * ev * ev


@kernel
def _information(a, b, c):
    """Inverse of [[a, b], [b, c]]; zeros where it is not positive definite."""
    det = a * c - b * b
    if not (det > 0.0 and a > 0.0 and det < np.inf):
        return 0.0, 0.0, 0.0
    return c / det, -b / det, a / det


@kernel
def weigh(xy, covariances, floor2, gate_floor2, lens, info, gate_info, ray_info):
    """Fills the information of each point in pixels, the same for the gate (larger floor), and that one on z = 1."""
    for i in range(len(xy)):
        C = covariances[i]
        a, b, c = C[0, 0], 0.5 * (C[0, 1] + C[1, 0]), C[1, 1]
        put(info[i], UU, _information(a + floor2, b, c + floor2))
        ga, gb, gc = _information(a + gate_floor2, b, c + gate_floor2)
        put(gate_info[i], UU, (ga, gb, gc))
        _, _, ux, uy, vx, vy = distort(xy[i, 0], xy[i, 1], lens)
        ray_info[i, UU] = ux * (ga * ux + gb * vx) + vx * (gb * ux + gc * vx)
        ray_info[i, UV] = ux * (ga * uy + gb * vy) + vx * (gb * uy + gc * vy)
        ray_info[i, VV] = uy * (ga * uy + gb * vy) + vy * (gb * uy + gc * vy)
