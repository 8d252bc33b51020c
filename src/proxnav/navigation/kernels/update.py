"""Measurement updates in Joseph form, and the keypoint measurement. State layout: proxnav.navigation.layout."""

from typing import no_type_check

import numpy as np
from numba import njit

from proxnav.navigation.kernels.prediction import corrected
from proxnav.navigation.kernels.rotations import skew, to_matrix

TOO_FEW, DISAGREES, ACCEPTED = 0, 1, 2
"""Outcomes of a frame of keypoints."""


@njit(cache=True)
@no_type_check
def joseph(P, H, R, y):
    """(error step, covariance, normalised innovation squared) of a dense measurement y = H e + noise."""
    HP = H @ P
    S = HP @ H.T + R
    both = np.linalg.solve(S, np.column_stack((HP, y)))
    K = np.ascontiguousarray(both[:, :-1].T)
    A = np.eye(len(P)) - K @ H
    out = A @ P @ A.T + K @ R @ K.T
    return K @ y, _rounded(out, P), y @ np.ascontiguousarray(both[:, -1])


@njit(cache=True)
@no_type_check
def _rounded(out, prior):
    """Symmetric, with the rounding errors of the update (some ulp of the prior) on the safe side of zero."""
    out = 0.5 * (out + out.T)
    for i in range(len(out)):
        out[i, i] += 2e-15 * prior[i, i]
    return out


@njit(cache=True)
@no_type_check
def reset(P, e):
    """P about the corrected attitude: G P G^T with G = I - [e/2]x for both attitudes."""
    out = P.copy()
    for first in (6, 9):
        G = np.eye(3) - 0.5 * skew(e[first : first + 3])
        out[first : first + 3, :] = G @ np.ascontiguousarray(out[first : first + 3, :])
        out[:, first : first + 3] = np.ascontiguousarray(out[:, first : first + 3]) @ G.T
    return 0.5 * (out + out.T)


@njit(cache=True)
@no_type_check
def keypoint_model(x, points, index, R_eci_ric, lens):
    """(predicted pixels, H on r, camera and relative attitude) of the points `index`; NaN behind the camera."""
    R_ce = to_matrix(x[6:10]).T
    R_ct, R_cr = to_matrix(x[10:14]), R_ce @ R_eci_ric
    t = -R_cr @ x[:3]
    T = skew(t)
    m = len(index)
    z, H = np.empty(2 * m), np.empty((2 * m, 9))
    J = np.zeros((2, 3))
    for k in range(m):
        p = points[index[k]]
        c = R_ct @ p + t
        if c[2] < 0.1:
            z[2 * k : 2 * k + 2] = np.nan
            H[2 * k : 2 * k + 2] = 0.0
            continue
        z[2 * k] = lens[0] * c[0] / c[2] + lens[2]
        z[2 * k + 1] = lens[1] * c[1] / c[2] + lens[3]
        J[0, 0], J[0, 2] = lens[0] / c[2], -lens[0] * c[0] / c[2] ** 2
        J[1, 1], J[1, 2] = lens[1] / c[2], -lens[1] * c[1] / c[2] ** 2
        H[2 * k : 2 * k + 2, 0:3] = -J @ R_cr
        H[2 * k : 2 * k + 2, 3:6] = J @ T
        H[2 * k : 2 * k + 2, 6:9] = -J @ (R_ct @ skew(p))
    return z, H


@njit(cache=True)
@no_type_check
def _times_P(H9, L, index, P):
    """H P, with H on r, both attitudes and each keypoint's own camera errors."""
    P9 = np.empty((9, len(P)))
    P9[:3], P9[3:] = P[:3], P[6:12]
    M = H9 @ P9
    for k in range(len(index)):
        c = 24 + 2 * index[k]
        for a in range(2):
            for b in range(2):
                if L[k, a, b] != 0.0:
                    M[2 * k + a] += L[k, a, b] * P[c + b]
    return M


@njit(cache=True)
@no_type_check
def _times_Ht(A, H9, L, index):
    """A H^T."""
    A9 = np.empty((len(A), 9))
    A9[:, :3], A9[:, 3:] = A[:, :3], A[:, 6:12]
    out = A9 @ H9.T
    for k in range(len(index)):
        c = 24 + 2 * index[k]
        for i in range(len(A)):
            out[i, 2 * k] += A[i, c] * L[k, 0, 0] + A[i, c + 1] * L[k, 0, 1]
            out[i, 2 * k + 1] += A[i, c] * L[k, 1, 0] + A[i, c + 1] * L[k, 1, 1]
    return out


@njit(cache=True)
@no_type_check
def _split(cov, share):
    """Lower root of the lasting part of each covariance, and the white part."""
    m = len(cov)
    L, R = np.zeros((m, 2, 2)), np.empty((m, 2, 2))
    for k in range(m):
        R[k] = (1.0 - share) * cov[k]
        a = np.sqrt(share * cov[k, 0, 0])
        if a > 0.0:
            L[k, 0, 0], L[k, 1, 0] = a, share * cov[k, 1, 0] / a
            L[k, 1, 1] = np.sqrt(max(share * cov[k, 1, 1] - L[k, 1, 0] ** 2, 0.0))
    return L, R


@njit(cache=True)
@no_type_check
def _add_noise(S, R):
    for k in range(len(R)):
        for a in range(2):
            for b in range(2):
                S[2 * k + a, 2 * k + b] += R[k, a, b]


@njit(cache=True)
@no_type_check
def _own_errors(x, L, index):
    """Pixels that the lasting errors add."""
    out = np.empty(2 * len(index))
    for k in range(len(index)):
        c = x[26 + 2 * index[k] : 28 + 2 * index[k]]
        out[2 * k] = L[k, 0, 0] * c[0] + L[k, 0, 1] * c[1]
        out[2 * k + 1] = L[k, 1, 0] * c[0] + L[k, 1, 1] * c[1]
    return out


@njit(cache=True)
@no_type_check
def _gate(y, S, gate):
    """Which keypoints lie within their own 2x2 innovation covariance."""
    m = len(y) // 2
    keep = np.zeros(m, dtype=np.bool_)
    for k in range(m):
        a, b, c = S[2 * k, 2 * k], S[2 * k, 2 * k + 1], S[2 * k + 1, 2 * k + 1]
        u, v = y[2 * k], y[2 * k + 1]
        d2 = (c * u * u - 2.0 * b * u * v + a * v * v) / (a * c - b * b)
        keep[k] = d2 <= gate  # False for NaN
    return keep


@njit(cache=True)
@no_type_check
def keypoint_update(x, P, pixels, cov, points, index, R_eci_ric, lens, share, gate, frame_gates, least_share):
    """(x, P, outcome, accepted keypoints, normalised innovation squared) from the keypoints `index` of one frame.

    Each keypoint is gated by itself, then all accepted ones together; far from the truth the update is iterated.
    """
    used = np.zeros(len(points), dtype=np.bool_)
    L, R = _split(cov[index], share)
    z = pixels[index].copy().ravel()
    h, H9 = keypoint_model(x, points, index, R_eci_ric, lens)
    S = _times_Ht(_times_P(H9, L, index, P), H9, L, index)
    _add_noise(S, R)
    keep = _gate(z - h - _own_errors(x, L, index), S, gate)
    m = int(keep.sum())
    if m == 0 or m < least_share * len(index):
        return x, P, DISAGREES if len(index) > 0 else TOO_FEW, used, np.nan
    index, L, R, z = index[keep], L[keep], R[keep], np.ascontiguousarray(z.reshape(-1, 2)[keep]).ravel()
    e, state, nis = np.zeros(len(P)), x, 0.0
    for turn in range(4):
        h, H9 = keypoint_model(state, points, index, R_eci_ric, lens)
        if not np.isfinite(h).all():  # the step leads behind the camera: too far to be believed
            return x, P, DISAGREES, used, nis
        M = _times_P(H9, L, index, P)
        S = _times_Ht(M, H9, L, index)
        _add_noise(S, R)
        y = z - h - _own_errors(state, L, index) + _applied(H9, L, index, e)
        both = np.linalg.solve(S, np.column_stack((M, y)))
        if turn == 0:
            nis = y @ np.ascontiguousarray(both[:, -1])
            if not nis <= frame_gates[2 * m]:
                return x, P, DISAGREES, used, nis
        Kt = np.ascontiguousarray(both[:, :-1])
        before, e = e, Kt.T @ y
        state = corrected(x, e)
        if np.abs(_applied(H9, L, index, e - before)).max() < 5.0:  # px: linear enough
            break
    AP = P - Kt.T @ M
    B = _times_Ht(AP, H9, L, index)
    for k in range(m):
        B[:, 2 * k : 2 * k + 2] -= Kt[2 * k : 2 * k + 2].T @ R[k]
    out = AP - B @ Kt
    used[index] = True
    return state, reset(_rounded(out, P), e), ACCEPTED, used, nis


@njit(cache=True)
@no_type_check
def _applied(H9, L, index, e):
    """H e."""
    e9 = np.empty(9)
    e9[:3], e9[3:] = e[:3], e[6:12]
    out = H9 @ e9
    for k in range(len(index)):
        c = 24 + 2 * index[k]
        out[2 * k] += L[k, 0, 0] * e[c] + L[k, 0, 1] * e[c + 1]
        out[2 * k + 1] += L[k, 1, 0] * e[c] + L[k, 1, 1] * e[c + 1]
    return out
