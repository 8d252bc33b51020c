"""Robust, covariance-weighted Levenberg-Marquardt on pixels, with the distorted projection."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.lens import distort


@kernel
def distances(R, t, X, pixels, info, lens, side, d2):
    """Squared Mahalanobis reprojection errors with the distorted projection; infinite on the wrong side."""
    for i in range(len(X)):
        z = R[2, 0] * X[i, 0] + R[2, 1] * X[i, 1] + R[2, 2] * X[i, 2] + t[2]
        d2[i] = np.inf
        if z * side > 0.0:
            x = (R[0, 0] * X[i, 0] + R[0, 1] * X[i, 1] + R[0, 2] * X[i, 2] + t[0]) / z
            y = (R[1, 0] * X[i, 0] + R[1, 1] * X[i, 1] + R[1, 2] * X[i, 2] + t[1]) / z
            if x * x + y * y <= lens[9]:
                u, v, _, _, _, _ = distort(x, y, lens)
                eu, ev = u - pixels[i, 0], v - pixels[i, 1]
                d2[i] = eu * (info[i, 0] * eu + 2.0 * info[i, 1] * ev) + info[i, 2] * ev * ev


@kernel
def _rho(d2, loss, k2):
    """Robust cost and weight of a squared error: loss 0 squares, 1 Huber, 2 Cauchy, with k2 = k^2."""
    if loss == 2:
        return k2 * math.log1p(d2 / k2), 1.0 / (1.0 + d2 / k2)
    if loss == 1 and d2 > k2:
        return 2.0 * math.sqrt(k2 * d2) - k2, math.sqrt(k2 / d2)
    return d2, 1.0


@kernel
def normal_equations(R, t, X, pixels, info, use, lens, side, loss, k2, H, g):
    """H = J^T W J and g = J^T W e for (dt, dr) with t + dt, exp(dr) R; returns the robust cost.

    J = [Jpi, -Jpi [R p]x], Jpi the Jacobian of the distorted projection.
    """
    H[:], g[:] = 0.0, 0.0
    cost = 0.0
    J = np.empty((2, 6))
    for i in range(len(X)):
        if not use[i]:
            continue
        r0 = R[0, 0] * X[i, 0] + R[0, 1] * X[i, 1] + R[0, 2] * X[i, 2]
        r1 = R[1, 0] * X[i, 0] + R[1, 1] * X[i, 1] + R[1, 2] * X[i, 2]
        r2 = R[2, 0] * X[i, 0] + R[2, 1] * X[i, 1] + R[2, 2] * X[i, 2]
        z = r2 + t[2]
        x, y = (r0 + t[0]) / z, (r1 + t[1]) / z
        if z * side <= 0.0 or x * x + y * y > lens[9]:
            return np.inf
        u, v, ux, uy, vx, vy = distort(x, y, lens)
        eu, ev = pixels[i, 0] - u, pixels[i, 1] - v
        a, b, c = info[i, 0], info[i, 1], info[i, 2]
        rho, weight = _rho(eu * (a * eu + 2.0 * b * ev) + c * ev * ev, loss, k2)
        cost += rho
        for row in range(2):
            j0, j1 = (ux / z, uy / z) if row == 0 else (vx / z, vy / z)
            j2 = -(j0 * x + j1 * y)
            J[row, 0], J[row, 1], J[row, 2] = j0, j1, j2
            J[row, 3], J[row, 4], J[row, 5] = j2 * r1 - j1 * r2, j0 * r2 - j2 * r0, j1 * r0 - j0 * r1
        for m in range(6):
            wu, wv = weight * (a * J[0, m] + b * J[1, m]), weight * (b * J[0, m] + c * J[1, m])
            g[m] += wu * eu + wv * ev
            for q in range(m, 6):
                H[m, q] += wu * J[0, q] + wv * J[1, q]
    for m in range(6):
        for q in range(m):
            H[m, q] = H[q, m]
    return cost


@kernel
def _solve6(H, g, damping, step):
    """step = (H + damping diag H)^-1 g by Cholesky; False when H is not positive definite."""
    L = np.zeros((6, 6))
    for i in range(6):
        for j in range(i + 1):
            s = H[i, j] * (1.0 + damping) if i == j else H[i, j]
            for k in range(j):
                s -= L[i, k] * L[j, k]
            if i == j:
                if not s > 1e-14 * H[i, i]:
                    return False
                L[i, i] = math.sqrt(s)
            else:
                L[i, j] = s / L[j, j]
    for i in range(6):
        s = g[i]
        for k in range(i):
            s -= L[i, k] * step[k]
        step[i] = s / L[i, i]
    for i in range(5, -1, -1):
        s = step[i]
        for k in range(i + 1, 6):
            s -= L[k, i] * step[k]
        step[i] = s / L[i, i]
    return True


@kernel
def perturb(R, t, step, R_out, t_out):
    """t + dt and exp(dr) R (Rodrigues)."""
    a, b, c = step[3], step[4], step[5]
    angle2 = a * a + b * b + c * c
    angle = math.sqrt(angle2)
    s = math.sin(angle) / angle if angle > 1e-8 else 1.0
    h = (1.0 - math.cos(angle)) / angle2 if angle > 1e-4 else 0.5 - angle2 / 24.0
    for k in range(3):
        x, y, z = R[0, k], R[1, k], R[2, k]
        cx, cy, cz = b * z - c * y, c * x - a * z, a * y - b * x
        R_out[0, k] = x + s * cx + h * (b * cz - c * cy)
        R_out[1, k] = y + s * cy + h * (c * cx - a * cz)
        R_out[2, k] = z + s * cz + h * (a * cy - b * cx)
        t_out[k] = t[k] + step[k]


@kernel
def refine(R, t, X, pixels, info, use, lens, side, loss, k2, iterations):
    """Levenberg-Marquardt in place on the points in use; returns the robust cost."""
    H, g, step = np.empty((6, 6)), np.empty(6), np.empty(6)
    H2, g2, R2, t2 = np.empty((6, 6)), np.empty(6), np.empty((3, 3)), np.empty(3)
    cost, damping = normal_equations(R, t, X, pixels, info, use, lens, side, loss, k2, H, g), 1e-4
    if cost == np.inf:
        return cost
    for _ in range(iterations):
        if not _solve6(H, g, damping, step):
            damping = max(10.0 * damping, 1e-6)
            if damping > 1e8:
                break
            continue
        perturb(R, t, step, R2, t2)
        cost2 = normal_equations(R2, t2, X, pixels, info, use, lens, side, loss, k2, H2, g2)
        if cost2 <= cost:
            gain = cost - cost2
            R[:], t[:], H[:], g[:], cost = R2, t2, H2, g2, cost2
            damping *= 0.1
            if gain <= 1e-7 * cost + 1e-22:
                break
        else:
            damping *= 10.0
            if damping > 1e8:
                break
    return cost


@kernel
def to_wxyz(R):
    """Unit quaternion of a rotation matrix, largest component first computed (S. W. Shepperd, 1978)."""
    q = np.empty(4)
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    i = 0
    for k in range(1, 3):
        if R[k, k] > R[i, i]:
            i = k
    if trace > R[i, i]:
        q[0] = 1.0 + trace
        q[1], q[2], q[3] = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    else:
        j, k = (i + 1) % 3, (i + 2) % 3
        q[0], q[1 + i] = R[k, j] - R[j, k], 1.0 - trace + 2.0 * R[i, i]
        q[1 + j], q[1 + k] = R[j, i] + R[i, j], R[k, i] + R[i, k]
    return q / math.sqrt(np.sum(q * q))
