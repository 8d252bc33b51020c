"""Light that the ground and the sea send back."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import fast_inlined_kernel, fast_kernel, fast_pasted_kernel
from proxnav.rendering.earth import noise
from proxnav.rendering.earth.imagery import BLUE, CITY, GREEN, RED, SLOPE_EAST, SLOPE_NORTH

WIND_MPS = 5.0  # m/s at 12.5 m, mean over the sea
WATER_REFLECTANCE = np.array([0.006, 0.016, 0.030])  # diffuse, from below the surface of clear ocean
RELIEF = 0.35  # slope of the terrain at full scale of the relief map


@fast_kernel
def fresnel_water(cos_i):
    """Unpolarised reflectance of still water (n = 1.34) at incidence angle arccos(cos_i)."""
    sin_t2 = (1.0 - cos_i * cos_i) / (1.34 * 1.34)
    cos_t = math.sqrt(max(0.0, 1.0 - sin_t2))
    s = (cos_i - 1.34 * cos_t) / (cos_i + 1.34 * cos_t)
    p = (1.34 * cos_i - cos_t) / (1.34 * cos_i + cos_t)
    return 0.5 * (s * s + p * p)


@fast_inlined_kernel
def glint(cos_view, cos_sun, cos_between, wind):
    """Radiance of the Sun mirrored in waves per unit irradiance [1/sr].

    Isotropic slope distribution of C. Cox and W. Munk, J. Opt. Soc. Am. 44, 838 (1954): variance 0.003 + 0.00512 wind.
    cos_between: between the directions to the eye and to the Sun.
    """
    if cos_view <= 0.0 or cos_sun <= 0.0:
        return 0.0
    half = math.sqrt(max(1e-12, 0.5 * (1.0 + cos_between)))  # cosine of incidence on the facet
    cos_tilt = (cos_view + cos_sun) / (2.0 * half)
    cos2 = cos_tilt * cos_tilt
    variance = 0.003 + 0.00512 * wind
    slopes = math.exp(-(1.0 - cos2) / (cos2 * variance)) / (math.pi * variance)
    # Waves hide each other at grazing angles, which bounds the pole of 1 / cos_view.
    grazing = max(cos_view, 0.6 * math.sqrt(variance)) * max(cos_sun, 0.6 * math.sqrt(variance)) / max(cos_sun, 1e-6)
    return fresnel_water(half) * slopes / (4.0 * grazing * cos2 * cos2)


@fast_inlined_kernel
def wind_mps(table, x, y, z):
    """Wind over the sea at a point of the unit sphere: calm patches and fresh ones, 20 to 500 km wide."""
    gusts, _ = noise.sample(table, x * 3.1, y * 3.1, z * 3.1)
    streaks, _ = noise.sample(table, x * 21.0, y * 21.0, z * 21.0)
    return max(1.0, WIND_MPS * (1.0 + 0.35 * gusts + 0.15 * streaks))


@fast_pasted_kernel
def _crisp(f):
    """Interpolation weight that keeps a texel's colour longer: bent by noise, borders look drawn instead of blurred."""
    f = min(1.0, max(0.0, 1.2 * f - 0.1))
    return f * f * (3.0 - 2.0 * f)


@fast_inlined_kernel
def read_ground(level, lon, lat, out):
    """Channels of a ground map, bilinear, decoded into `out` (7)."""
    rows, columns = level.shape[0], level.shape[1]
    y, x = (0.5 - lat / math.pi) * rows - 0.5, (lon / (2.0 * math.pi) + 0.5) * columns - 0.5
    i, j = math.floor(y), math.floor(x)
    fy, fx = _crisp(y - i), _crisp(x - j)
    i0, i1 = min(max(int(i), 0), rows - 1), min(max(int(i) + 1, 0), rows - 1)
    j0 = int(j)
    j0 = j0 + columns if j0 < 0 else (j0 - columns if j0 >= columns else j0)
    j1 = 0 if j0 == columns - 1 else j0 + 1
    w00, w01, w10, w11 = (1.0 - fy) * (1.0 - fx), (1.0 - fy) * fx, fy * (1.0 - fx), fy * fx
    for k in range(7):
        mix = w00 * level[i0, j0, k] + w01 * level[i0, j1, k] + w10 * level[i1, j0, k] + w11 * level[i1, j1, k]
        out[k] = mix / 255.0
    out[RED], out[GREEN], out[BLUE], out[CITY] = out[RED] ** 2, out[GREEN] ** 2, out[BLUE] ** 2, out[CITY] ** 2
    out[SLOPE_EAST], out[SLOPE_NORTH] = 2.0 * out[SLOPE_EAST] - 1.0, 2.0 * out[SLOPE_NORTH] - 1.0
