"""Robust, covariance-weighted Levenberg-Marquardt on pixels, with the distorted projection."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.lens import FOLD2, distort
from proxnav.geometry.compiled.perturbation import moved, step_gradient
from proxnav.geometry.compiled.vectors import rotate, triple
from proxnav.pose.solve.kernels.weights import UU, squared


@kernel
def distances(R, t, X, pixels, info, lens, side, d2):
    """Squared Mahalanobis reprojection errors with the distorted projection; infinite on the wrong side."""
    for i in range(len(X)):
        p = rotate(R, X[i])
        z = p[2] + t[2]
        d2[i] = np.inf
        if z * side > 0.0:
            x, y = (p[0] + t[0]) / z, (p[1] + t[1]) / z
            if x * x + y * y <= lens[FOLD2]:
                u, v, _, _, _, _ = distort(x, y, lens)
                d2[i] = squared(info[i], u - pixels[i, 0], v - pixels[i, 1])


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
    for i in range(len(X)):
        if not use[i]:
            continue
        p = rotate(R, X[i])
        z = p[2] + t[2]
        x, y = (p[0] + t[0]) / z, (p[1] + t[1]) / z
        if z * side <= 0.0 or x * x + y * y > lens[FOLD2]:
            return np.inf
        u, v, ux, uy, vx, vy = distort(x, y, lens)
        eu, ev = pixels[i, 0] - u, pixels[i, 1] - v
        rho, weight = _rho(squared(info[i], eu, ev), loss, k2)
        cost += rho
        Ju, Jv = step_gradient(ux / z, uy / z, x, y, p), step_gradient(vx / z, vy / z, x, y, p)
        a, b, c = triple(info[i], UU)
        for m in range(6):
            wu, wv = weight * (a * Ju[m] + b * Jv[m]), weight * (b * Ju[m] + c * Jv[m])
            g[m] += wu * eu + wv * ev
            for q in range(m, 6):
                H[m, q] += wu * Ju[q] + wv * Jv[q]
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
        moved(R, t, step, R2, t2)
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
