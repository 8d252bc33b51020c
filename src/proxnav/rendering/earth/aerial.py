"""Air between the eye and what it sees, from one point: tables over the direction, filled where rays ask.

From a fixed point, light scattered into a ray depends on the ray's nadir angle and on its azimuth against the Sun only;
it is smooth in both apart from the phase functions, which are applied per ray. Three tables: rays that end on the
ground, on the cloud shell, and nowhere.
"""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Float32

from proxnav.geometry.compiled.kernel import fast_kernel, fast_pasted_kernel
from proxnav.rendering.earth.atmosphere import (
    FROM_AEROSOL,
    FROM_AIR,
    ISOTROPIC,
    PATH,
    R_TOP,
    THROUGH,
    march,
    mie_phase,
    rayleigh_phase,
)
from proxnav.rendering.earth.ellipsoid import A_M, near_hit

N_NADIR, N_AZIMUTH = 72, 40
STEPS = 32  # integrals converged to 1 %
GROUND, CLOUD, SKY = 0, 1, 2
SCATTERED, BEHIND = 0, 3
"""Places in what `look` fills, three bands each."""
CLOUD_TOP_M = 5e3  # m, the shell on which clouds are drawn


class Aerial(NamedTuple):
    """The tables of one eye point and Sun direction."""

    nodes: Float32[np.ndarray, "table=3 n_nadir n_azimuth path=12"]
    """Rayleigh, Mie, isotropic, transmittance, three bands each."""
    done: Bool[np.ndarray, "table=3 n_nadir n_azimuth"]
    """Which nodes have been computed."""
    bounds: Float[np.ndarray, "table=3 2"]
    """Cosine of the nadir angle at the horizon edge of each table and at its other end."""
    radius: float
    """Distance of the eye from Earth's centre, in stretched space [m]."""
    mu_sun: float
    """Cosine of the Sun's zenith angle at the eye."""
    work: Float[np.ndarray, "path=12"]
    """Room for one path."""


def empty(radius: float, mu_sun: float) -> Aerial:
    """Tables without any node yet."""
    edge = [math.sqrt(max(0.0, 1.0 - (shell / radius) ** 2)) for shell in (A_M, A_M + CLOUD_TOP_M, R_TOP)]
    top = edge[2] if radius > R_TOP else -1.0
    bounds = np.array([[edge[0], 1.0], [edge[1], 1.0], [edge[0], top]])
    nodes = np.zeros((3, N_NADIR, N_AZIMUTH, PATH), dtype=np.float32)
    return Aerial(nodes, np.zeros((3, N_NADIR, N_AZIMUTH), dtype=np.bool_), bounds, radius, mu_sun, np.empty(PATH))


@fast_kernel
def _fill(aerial, transmittance, multiple, kind, i, j):
    edge, end = aerial.bounds[kind, 0], aerial.bounds[kind, 1]
    u = i / (N_NADIR - 1)
    down = edge + (end - edge) * u * u  # cosine of the nadir angle
    cos_azimuth = 1.0 - 2.0 * j / (N_AZIMUTH - 1)
    r0, mu_sun, mu = aerial.radius, aerial.mu_sun, -down
    nu = mu * mu_sun + math.sqrt(max(0.0, (1 - mu * mu) * (1 - mu_sun * mu_sun))) * cos_azimuth
    if kind == SKY:
        length = -r0 * mu + math.sqrt(max(0.0, R_TOP * R_TOP - r0 * r0 * (1.0 - mu * mu)))
    else:
        shell = A_M if kind == GROUND else A_M + CLOUD_TOP_M
        length = near_hit(1.0, r0 * mu, shell, r0)
        if length < 0.0:  # the horizon node itself, missed by rounding
            length = -r0 * mu
    out = aerial.work
    march(transmittance, multiple, r0, mu, mu_sun, nu, length, STEPS, out)
    for k in range(PATH):
        aerial.nodes[kind, i, j, k] = out[k]
    aerial.done[kind, i, j] = True


@fast_kernel
def look(aerial, transmittance, multiple, kind, down, cos_azimuth, nu, out):
    """Fills `out`: SCATTERED, light per unit Sun irradiance [1/sr], and BEHIND, transmittance of the path."""
    edge, end = aerial.bounds[kind, 0], aerial.bounds[kind, 1]
    x = math.sqrt(min(1.0, max(0.0, (down - edge) / (end - edge)))) * (N_NADIR - 1)
    y = min(1.0, max(0.0, 0.5 * (1.0 - cos_azimuth))) * (N_AZIMUTH - 1)
    i, j = min(int(x), N_NADIR - 2), min(int(y), N_AZIMUTH - 2)
    for di in range(2):
        for dj in range(2):
            if not aerial.done[kind, i + di, j + dj]:
                _fill(aerial, transmittance, multiple, kind, i + di, j + dj)
    fx, fy = x - i, y - j
    w00, w01, w10, w11 = (1.0 - fx) * (1.0 - fy), (1.0 - fx) * fy, fx * (1.0 - fy), fx * fy
    n = aerial.nodes
    phase_r, phase_m = rayleigh_phase(nu), mie_phase(nu)
    for k in range(3):
        r = _mix(n, kind, i, j, FROM_AIR + k, w00, w01, w10, w11)
        m = _mix(n, kind, i, j, FROM_AEROSOL + k, w00, w01, w10, w11)
        out[SCATTERED + k] = phase_r * r + phase_m * m + _mix(n, kind, i, j, ISOTROPIC + k, w00, w01, w10, w11)
        out[BEHIND + k] = _mix(n, kind, i, j, THROUGH + k, w00, w01, w10, w11)


@fast_pasted_kernel
def _mix(n, a, i, j, k, w00, w01, w10, w11):
    return w00 * n[a, i, j, k] + w01 * n[a, i, j + 1, k] + w10 * n[a, i + 1, j, k] + w11 * n[a, i + 1, j + 1, k]
