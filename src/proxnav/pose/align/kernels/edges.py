"""Where the image has its edges along the normals of an outline, and the normal equations that pull the pose there."""

import math

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.lens import distort
from proxnav.geometry.compiled.perturbation import step_gradient
from proxnav.geometry.compiled.vectors import rotate


@kernel
def _read(image, u, v):
    """Bilinear value at a corner-origin pixel position; 0 outside."""
    x, y = u - 0.5, v - 0.5
    height, width = image.shape
    if not (0.0 <= x < width - 1 and 0.0 <= y < height - 1):
        return 0.0
    i, j = int(x), int(y)
    fx, fy = x - i, y - j
    upper = image[j, i] * (1.0 - fx) + image[j, i + 1] * fx
    lower = image[j + 1, i] * (1.0 - fx) + image[j + 1, i + 1] * fx
    return upper * (1.0 - fy) + lower * fy


@kernel
def _strength(gx, gy, u, v, nx, ny):
    """Gradient along the normal [counts/px], less where the gradient points elsewhere."""
    a, b = _read(gx, u, v), _read(gy, u, v)
    along = a * nx + b * ny
    return along * along / (math.sqrt(a * a + b * b) + 1e-9)


@kernel
def share_on_edges(X, N, R, t, lens, gx, gy, noise):
    """Mean over the outline of (g.n)^2 / (|g|^2 + noise^2), g the image gradient: 1 where every point lies on an edge.

    C. Steger, "Similarity measures for occlusion, clutter, and illumination invariant object recognition", 2001,
    without the sign: whether the target is brighter than what lies behind it is not known.
    """
    total = 0.0
    for i in range(len(X)):
        p = rotate(R, X[i])
        z = p[2] + t[2]
        if z <= 1e-6:
            continue
        u, v, _, _, _, _ = distort((p[0] + t[0]) / z, (p[1] + t[1]) / z, lens)
        a, b = _read(gx, u, v), _read(gy, u, v)
        along = a * N[i, 0] + b * N[i, 1]
        total += along * along / (a * a + b * b + noise * noise)
    return total / max(len(X), 1)


@kernel
def _nearest_edges(gx, gy, u, v, nx, ny, reach, sigma, least, outlier):
    """(probability that an edge was found, its mean offset [px]) among the maxima of the gradient along a normal."""
    step = 1.0 if sigma > 2.0 else 0.5
    half = int(reach / step)
    before, here, weight, sum_ = 0.0, 0.0, 0.0, 0.0
    for k in range(-half - 1, half + 2):
        s = k * step
        after = _strength(gx, gy, u + s * nx, v + s * ny, nx, ny)
        if k > -half and here >= before and here > after and here > least:
            bend = before - 2.0 * here + after
            at = (k - 1 + (0.5 * (before - after) / bend if bend < 0.0 else 0.0)) * step
            w = min(here / (3.0 * least), 3.0) * math.exp(-0.5 * (at / sigma) ** 2)
            weight += w
            sum_ += w * at
        before, here = here, after
    if weight <= 0.0:
        return 0.0, 0.0
    return weight / (weight + outlier), sum_ / weight


@kernel
def edge_equations(X, N, R, t, lens, gx, gy, reach, sigma, least, outlier, H, g):
    """H = sum p J^T J and g = sum p J^T e over the outline, e the offset [px] of the edge along the normal.

    J = n^T Jpi [I, -[R p]x] for (dt, dr) with t + dt, exp(dr) R; each maximum of the gradient within `reach` counts by
    its strength and a Gaussian of `sigma` px, against `outlier` for none. Returns the sum of p.
    T. Drummond, R. Cipolla, "Real-time visual tracking of complex structures", PAMI 24(7), 2002, with soft assignment.
    """
    H[:], g[:] = 0.0, 0.0
    found = 0.0
    for i in range(len(X)):
        r = rotate(R, X[i])
        z = r[2] + t[2]
        if z <= 1e-6:
            continue
        x, y = (r[0] + t[0]) / z, (r[1] + t[1]) / z
        u, v, ux, uy, vx, vy = distort(x, y, lens)
        nx, ny = N[i, 0], N[i, 1]
        p, offset = _nearest_edges(gx, gy, u, v, nx, ny, reach, sigma, least, outlier)
        if p < 1e-3:
            continue
        J = step_gradient((nx * ux + ny * vx) / z, (nx * uy + ny * vy) / z, x, y, r)
        for m in range(6):
            g[m] += p * J[m] * offset
            for q in range(6):
                H[m, q] += p * J[m] * J[q]
        found += p
    return found
