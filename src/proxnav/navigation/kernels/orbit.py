"""The target's orbit between ephemeris rows: RIC axes and orbital rate at any instant."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import kernel


@kernel
def orbit_at(times, r, v, t):
    """(r [m], v [m/s], R_eci_ric, orbital rate [rad/s]) by cubic Hermite interpolation of the ephemeris rows.

    Beyond the ends the last piece goes on.
    """
    k = min(max(np.searchsorted(times, t) - 1, 0), len(times) - 2)
    h = times[k + 1] - times[k]
    s = (t - times[k]) / h
    a, b = (1 + 2 * s) * (1 - s) ** 2, s * (1 - s) ** 2
    c, d = s * s * (3 - 2 * s), s * s * (s - 1)
    position = a * r[k] + b * h * v[k] + c * r[k + 1] + d * h * v[k + 1]
    da, db, dc, dd = 6 * s * s - 6 * s, 3 * s * s - 4 * s + 1, 6 * s - 6 * s * s, 3 * s * s - 2 * s
    velocity = (da * r[k] + dc * r[k + 1]) / h + db * v[k] + dd * v[k + 1]
    momentum = np.cross(position, velocity)
    radius, size = math.sqrt(position @ position), math.sqrt(momentum @ momentum)
    R = np.empty((3, 3))
    R[:, 0], R[:, 2] = position / radius, momentum / size
    R[:, 1] = np.cross(R[:, 2], R[:, 0])
    return position, velocity, R, size / (radius * radius)


@kernel
def ric_turning(n):
    """[w]x of RIC in its own axes, which turn about the third with n [rad/s]."""
    W = np.zeros((3, 3))
    W[0, 1], W[1, 0] = -n, n
    return W
