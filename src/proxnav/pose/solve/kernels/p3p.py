"""Pose from three points: at most four poses that put them on three rays."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.vectors import cross, dot, minus, over, rotate


@kernel
def _cubic_roots(c3, c2, c1, c0, roots):
    """Real roots of a cubic with c3 != 0, polished by Newton; returns how many."""
    a, b, c = c2 / c3, c1 / c3, c0 / c3
    q, r = (a * a - 3.0 * b) / 9.0, (2.0 * a * a * a - 9.0 * a * b + 27.0 * c) / 54.0
    if r * r < q * q * q:
        theta = math.acos(max(-1.0, min(1.0, r / math.sqrt(q * q * q))))
        count = 3
        for i in range(3):
            roots[i] = -2.0 * math.sqrt(q) * math.cos((theta + 2.0 * math.pi * i) / 3.0) - a / 3.0
    else:
        s = -math.copysign((abs(r) + math.sqrt(max(r * r - q * q * q, 0.0))) ** (1.0 / 3.0), r)
        roots[0] = s + (q / s if s != 0.0 else 0.0) - a / 3.0
        count = 1
    for i in range(count):
        for _ in range(2):
            x = roots[i]
            slope = (3.0 * x + 2.0 * a) * x + b
            if slope != 0.0:
                roots[i] = x - (((x + a) * x + b) * x + c) / slope
    return count


@kernel
def _adjugate(C):
    """Adjugate of a symmetric 3x3 matrix."""
    B = np.empty((3, 3))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        B[i, i] = C[j, j] * C[k, k] - C[j, k] * C[j, k]
        B[i, j] = B[j, i] = C[j, k] * C[i, k] - C[i, j] * C[k, k]
    return B


@kernel
def _split_conic(C, lines):
    """The two lines of a degenerate conic (J. Richter-Gebert, Perspectives on Projective Geometry, section 11.1)."""
    B = _adjugate(C)
    i = 0
    for k in range(1, 3):
        if B[k, k] < B[i, i]:
            i = k
    size = max(abs(C[0, 0]), abs(C[1, 1]), abs(C[2, 2]), abs(C[0, 1]), abs(C[0, 2]), abs(C[1, 2]))
    if B[i, i] > 1e-12 * size * size:
        return False
    beta = math.sqrt(max(-B[i, i], 1e-300))
    p0, p1, p2 = B[0, i] / beta, B[1, i] / beta, B[2, i] / beta
    D = C.copy()
    if -B[i, i] > 1e-14 * size * size:
        D[0, 1] += p2
        D[0, 2] -= p1
        D[1, 0] -= p2
        D[1, 2] += p0
        D[2, 0] += p1
        D[2, 1] -= p0
    at = np.argmax(np.abs(D))
    for k in range(3):
        lines[0, k], lines[1, k] = D[at // 3, k], D[k, at % 3]
    return True


@kernel
def _polish_depths(d, cosines, squares):
    """Gauss-Newton on the law of cosines for pairs (0,1), (0,2), (1,2); True when it holds to 1e-8."""
    for _ in range(3):
        r0 = d[0] * d[0] + d[1] * d[1] - 2.0 * d[0] * d[1] * cosines[0] - squares[0]
        r1 = d[0] * d[0] + d[2] * d[2] - 2.0 * d[0] * d[2] * cosines[1] - squares[1]
        r2 = d[1] * d[1] + d[2] * d[2] - 2.0 * d[1] * d[2] * cosines[2] - squares[2]
        a0, a1 = d[0] - d[1] * cosines[0], d[1] - d[0] * cosines[0]
        b0, b2 = d[0] - d[2] * cosines[1], d[2] - d[0] * cosines[1]
        c1, c2 = d[1] - d[2] * cosines[2], d[2] - d[1] * cosines[2]
        det = -2.0 * (a0 * b2 * c1 + a1 * b0 * c2)
        if det == 0.0:
            break
        d[0] -= (-b2 * c1 * r0 - a1 * c2 * r1 + a1 * b2 * r2) / det
        d[1] -= (-b0 * c2 * r0 + a0 * c2 * r1 - a0 * b2 * r2) / det
        d[2] -= (b0 * c1 * r0 - a0 * c1 * r1 - a1 * b0 * r2) / det
    size = squares[0] + squares[1] + squares[2]
    return abs(r0) + abs(r1) + abs(r2) < 1e-8 * size and d[0] > 0.0 and d[1] > 0.0 and d[2] > 0.0


@kernel
def _triad(p, E):
    """Orthonormal axes of a triangle (rows of p) as columns of E; False when it is a line."""
    a, b = minus(p[1], p[0]), minus(p[2], p[0])
    n = cross(a, b)
    length, area = math.sqrt(dot(a, a)), math.sqrt(dot(n, n))
    if not area > 1e-5 * max(length * length, dot(b, b)):
        return False
    x, z = over(a, length), over(n, area)
    y = cross(z, x)
    for k in range(3):
        E[k, 0], E[k, 1], E[k, 2] = x[k], y[k], z[k]
    return True


@kernel
def _form(Q, a, b):
    """a^T Q b."""
    return dot(a, rotate(Q, b))


@kernel
def _depths(line, Q, branch, cosines, squares, d):
    """Positive depths where a line meets the conic Q, scaled to the triangle; False when there are none."""
    k = np.argmax(np.abs(line))
    if line[k] == 0.0:
        return False
    i, j = (k + 1) % 3, (k + 2) % 3
    u, w = np.zeros(3), np.zeros(3)  # points of the line: numerator u + denominator w
    u[i], u[k] = 1.0, -line[i] / line[k]
    w[j], w[k] = 1.0, -line[j] / line[k]
    a, b, c = _form(Q, u, u), _form(Q, u, w), _form(Q, w, w)
    disc = b * b - a * c
    if disc < -1e-10 * (b * b + abs(a * c)):
        return False
    h = -(b + math.copysign(math.sqrt(max(disc, 0.0)), b))
    numerator, denominator = (h, a) if branch == 0 else (c, h)
    flip = 1.0 if (numerator + denominator) + numerator * u[k] + denominator * w[k] > 0.0 else -1.0
    for m in range(3):
        d[m] = flip * (numerator * u[m] + denominator * w[m])
    total = 2.0 * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
    total -= 2.0 * (d[0] * d[1] * cosines[0] + d[0] * d[2] * cosines[1] + d[1] * d[2] * cosines[2])
    if not (d[0] > 0.0 and d[1] > 0.0 and d[2] > 0.0 and total > 0.0):
        return False
    d *= math.sqrt((squares[0] + squares[1] + squares[2]) / total)
    return True


@kernel
def _align(d, rays, side, X, EX, R, t):
    """R, t that move the triangle X with axes EX onto the rays at depths d; returns 1, or 0 when it is a line."""
    P, EC = np.empty((3, 3)), np.empty((3, 3))
    for m in range(3):
        for axis in range(3):
            P[m, axis] = side * d[m] * rays[m, axis]
    if not _triad(P, EC):
        return 0
    for a in range(3):
        for b in range(3):
            R[a, b] = dot(EC[a], EX[b])
        t[a] = P[0, a] - dot(R[a], X[0])
    return 1


@kernel
def p3p(X, rays, side, R_out, t_out):
    """Poses (at most four) that put three points on three unit rays; returns how many.

    The depths are common points of two conics; the pencil's degenerate member gives two lines through them
    (M. Persson, K. Nordberg, "Lambda Twist", ECCV 2018; Y. Ding et al., "Revisiting the P3P problem", CVPR 2023).
    """
    EX = np.empty((3, 3))
    if not _triad(X, EX):
        return 0
    cosines, squares = np.empty(3), np.empty(3)
    for k in range(3):
        i, j = (0, 1) if k == 0 else ((0, 2) if k == 1 else (1, 2))
        cosines[k] = dot(rays[i], rays[j])
        squares[k] = (X[i, 0] - X[j, 0]) ** 2 + (X[i, 1] - X[j, 1]) ** 2 + (X[i, 2] - X[j, 2]) ** 2
    c12, c13, c23 = cosines[0], cosines[1], cosines[2]
    size = squares[0] + squares[1] + squares[2]
    a12, a13, a23 = squares[0] / size, squares[1] / size, squares[2] / size
    D1 = np.array([[a23, -a23 * c12, 0.0], [-a23 * c12, a23 - a12, a12 * c23], [0.0, a12 * c23, -a12]])
    D2 = np.array([[a23, 0.0, -a23 * c13], [0.0, -a13, a13 * c23], [-a23 * c13, a13 * c23, a23 - a13]])
    A1, A2 = _adjugate(D1), _adjugate(D2)
    c0, c3 = dot(D1[0], A1[0]), dot(D2[0], A2[0])
    if abs(c3) < abs(c0):
        D1, D2, A1, A2, c0, c3 = D2, D1, A2, A1, c3, c0
    c1, c2 = np.sum(A1 * D2), np.sum(A2 * D1)
    roots, lines = np.zeros(3), np.empty((2, 3))
    count = _cubic_roots(c3, c2, c1, c0, roots) if c3 != 0.0 else 1
    split = False
    for i in range(count):
        split = split or _split_conic(D1 + roots[i] * D2, lines)
        if split:
            Q = D2 if abs(roots[i]) < 1.0 else D1
            break
    if not split:
        return 0
    found = 0
    d = np.empty(3)
    for line in lines:
        for branch in range(2):
            if found < 4 and _depths(line, Q, branch, cosines, squares, d) and _polish_depths(d, cosines, squares):
                found += _align(d, rays, side, X, EX, R_out[found], t_out[found])
    return found
