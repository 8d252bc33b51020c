"""The reflectance of `proxnav.targets.surface.material` as numba functions: Fresnel, GGX and the mix of the lobes.

B. Walter et al., "Microfacet models for refraction through rough surfaces", EGSR 2007 (D and F);
E. Heitz, "Understanding the masking-shadowing function", JCGT 3(2), 2014 (height-correlated Smith, eq. 99).
"""

from functools import cache

import numpy as np
from jaxtyping import Float

from proxnav.geometry.compiled.kernel import ray_kernel

MIN_ALPHA = 1e-3
"""Below it a surface is a mirror to a light as wide as the Sun."""
_ROWS, _COLUMNS = 32, 32  # of the albedo table: cosine, square root of alpha


@ray_kernel
def fresnel(cosine, ior):
    """Unpolarised reflectance of a dielectric of index `ior` seen from outside (Walter et al., eq. 22)."""
    if ior == 1.0:
        return 0.0
    c = abs(cosine)
    g2 = ior * ior - 1.0 + c * c
    if g2 <= 0.0:
        return 1.0
    g = np.sqrt(g2)
    a = (g - c) / (g + c)
    b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0)
    return 0.5 * a * a * (1.0 + b * b)


@ray_kernel
def ggx(nl, nv, nh, alpha):
    """Value [1/sr] of the reflecting microfacet lobe: D G2 / (4 n.l n.v)."""
    a2 = alpha * alpha
    d = nh * nh * (a2 - 1.0) + 1.0
    D = a2 / (np.pi * d * d)
    smith = nl * np.sqrt(a2 + (1.0 - a2) * nv * nv) + nv * np.sqrt(a2 + (1.0 - a2) * nl * nl)
    return D * 0.5 / smith


@ray_kernel
def reflectance(nl, nv, nh, matt, metal, metallic, alpha, F, out):
    """Fills `out` (3) with f(v, l) [1/sr]; `matt` is (1 - metallic) albedo, `metal` is metallic albedo."""
    lobe = ggx(nl, nv, nh, alpha)
    for c in range(3):
        out[c] = (1.0 - F) * matt[c] / np.pi + ((1.0 - metallic) * F + metal[c]) * lobe


@ray_kernel
def _lobe_albedo(nv, alpha, steps):
    """Share of light from direction v that the lobe reflects, by sampling visible normals (Heitz, JCGT 7(4), 2018)."""
    vx = np.sqrt(1.0 - nv * nv)
    length = np.sqrt(alpha * alpha * vx * vx + nv * nv)
    wx, wz = alpha * vx / length, nv / length
    total = 0.0
    for i in range(steps):
        for j in range(steps):
            r, phi = np.sqrt((i + 0.5) / steps), 2.0 * np.pi * (j + 0.5) / steps
            t1, t2 = r * np.cos(phi), r * np.sin(phi)
            s = 0.5 * (1.0 + wz)
            t2 = (1.0 - s) * np.sqrt(max(0.0, 1.0 - t1 * t1)) + s * t2
            t3 = np.sqrt(max(0.0, 1.0 - t1 * t1 - t2 * t2))
            # basis: w = (wx, 0, wz), first axis (0, 1, 0), second w x first = (-wz, 0, wx)
            hx, hy, hz = -wz * t2 + wx * t3, t1, wx * t2 + wz * t3
            hx, hy = alpha * hx, alpha * hy
            norm = np.sqrt(hx * hx + hy * hy + hz * hz)
            vh = (vx * hx + nv * hz) / norm
            nl = 2.0 * vh * hz / norm - nv
            if nl > 0.0:
                a2 = alpha * alpha
                g1v = 2.0 * nv / (nv + np.sqrt(a2 + (1.0 - a2) * nv * nv))
                nl_root = np.sqrt(a2 + (1.0 - a2) * nl * nl)
                g2 = 2.0 * nl * nv / (nl * np.sqrt(a2 + (1.0 - a2) * nv * nv) + nv * nl_root)
                total += g2 / g1v
    return total / (steps * steps)


@cache
def lobe_albedo_table() -> Float[np.ndarray, "rows columns"]:
    """Directional albedo of the GGX lobe over n.v (rows) and sqrt(alpha) (columns), both from 0 to 1."""
    table = np.empty((_ROWS, _COLUMNS), np.float32)
    for i in range(_ROWS):
        for j in range(_COLUMNS):
            table[i, j] = _lobe_albedo(max(i / (_ROWS - 1), 1e-3), max((j / (_COLUMNS - 1)) ** 2, 1e-4), 24)
    return table


@ray_kernel
def table_albedo(table, nv, alpha):
    """Bilinear value of `lobe_albedo_table`."""
    y = min(max(nv, 0.0), 1.0) * (table.shape[0] - 1)
    x = np.sqrt(min(max(alpha, 0.0), 1.0)) * (table.shape[1] - 1)
    i, j = min(int(y), table.shape[0] - 2), min(int(x), table.shape[1] - 2)
    fy, fx = y - i, x - j
    upper = table[i, j] * (1.0 - fx) + table[i, j + 1] * fx
    lower = table[i + 1, j] * (1.0 - fx) + table[i + 1, j + 1] * fx
    return upper * (1.0 - fy) + lower * fy
