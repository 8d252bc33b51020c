"""Measurement updates in Joseph form, and the keypoint measurement. State layout: proxnav.navigation.layout."""

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.rotations import exp, multiply, skew, to_matrix
from proxnav.navigation.kernels.prediction import corrected

TOO_FEW, DISAGREES, ACCEPTED = 0, 1, 2
"""Outcomes of a frame of keypoints."""


@kernel
def joseph(P, columns, H, R, y):
    """(error step, covariance, normalised innovation squared) of a measurement y = H e[columns] + noise.

    P+ = (I - K H) P (I - K H)^T + K R K^T, multiplied out so that only the measured columns meet H.
    """
    HP = H @ P[columns]
    S = HP[:, columns] @ H.T + R
    both = np.linalg.solve(S, np.column_stack((HP, y)))
    Kt = np.ascontiguousarray(both[:, :-1])
    AP = P - Kt.T @ HP
    out = AP - (AP[:, columns] @ H.T - Kt.T @ R) @ Kt
    return Kt.T @ y, _rounded(out, P), y @ np.ascontiguousarray(both[:, -1])


@kernel
def _rounded(out, prior):
    """Symmetric, with the rounding errors of the update (some ulp of the prior) on the safe side of zero."""
    out = 0.5 * (out + out.T)
    for i in range(len(out)):
        out[i, i] += 2e-15 * prior[i, i]
    return out


@kernel
def reset(P, e):
    """P about the corrected attitude: G P G^T with G = I - [e/2]x for both attitudes."""
    out = P.copy()
    for first in (6, 9):
        G = np.eye(3) - 0.5 * skew(e[first : first + 3])
        out[first : first + 3, :] = G @ np.ascontiguousarray(out[first : first + 3, :])
        out[:, first : first + 3] = np.ascontiguousarray(out[:, first : first + 3]) @ G.T
    return 0.5 * (out + out.T)


@kernel
def gnss_model(x, R, n, rate_cam, own, other):
    """(H on r, v, both attitudes, target rate, gyro bias, GNSS bias; prediction) of the baseline and its rate in ECI.

    From antenna to antenna: `own` in camera axes, `other` in target axes; each turns about its craft's centre of mass.
    """
    R_ec, R_ct = to_matrix(x[6:10]), to_matrix(x[10:14])
    w_c, w_t = rate_cam - x[17:20], x[14:17]
    W = np.zeros((3, 3))
    W[0, 1], W[1, 0] = -n, n
    own_v, other_v = np.cross(w_c, own), R_ct @ np.cross(w_t, other)
    H = np.zeros((6, 21))
    H[:3, :3], H[:3, 18:] = R, np.eye(3)
    H[:3, 6:9], H[:3, 9:12] = -R_ec @ skew(own - R_ct @ other), R_ec @ R_ct @ skew(other)
    H[3:, :3], H[3:, 3:6] = R @ W, R
    H[3:, 6:9], H[3:, 9:12] = -R_ec @ skew(own_v - other_v), R_ec @ R_ct @ skew(np.cross(w_t, other))
    H[3:, 12:15], H[3:, 15:18] = R_ec @ R_ct @ skew(other), R_ec @ skew(own)
    h = np.empty(6)
    h[:3] = R @ x[:3] + R_ec @ (own - R_ct @ other) + x[23:26]
    h[3:] = R @ (x[3:6] + W @ x[:3]) + R_ec @ (own_v - other_v)
    return H, h


@kernel
def keypoint_model(x, points, index, R_eci_ric, lens):
    """(predicted pixels, H) of the points `index`; NaN behind the camera.

    H on r, both attitudes and the lasting pose error (the state's last six: dt in camera axes, dr in target axes), by
    which the detector sees the target displaced: c = R_cam_target exp(dr) p + t + dt. Attitude and dr share a column:
    no change of the linearisation point can tell one from the other.
    """
    R_cr = to_matrix(x[6:10]).T @ R_eci_ric
    R_ct = to_matrix(multiply(x[10:14], exp(x[-3:])))
    t = -R_cr @ x[:3]
    T, apparent = skew(t), t + x[-6:-3]
    m = len(index)
    z, H = np.empty(2 * m), np.empty((2 * m, 15))
    J = np.zeros((2, 3))
    for k in range(m):
        p = points[index[k]]
        c = R_ct @ p + apparent
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
        H[2 * k : 2 * k + 2, 9:12] = J
        H[2 * k : 2 * k + 2, 12:15] = H[2 * k : 2 * k + 2, 6:9]
    return z, H


@kernel
def pose_covariance(H, cov, distance):
    """Of the least-squares pose from keypoints with these covariances: dt in camera, dr in target axes.

    A frame of few points has no such pose: what any pose in view has bounds it.
    """
    A = np.zeros((6, 6))
    for i in range(3):
        A[i, i], A[3 + i, 3 + i] = 1.0 / (0.3 * distance) ** 2, 4.0
    for k in range(len(cov)):
        J = np.ascontiguousarray(H[2 * k : 2 * k + 2, 9:])
        A += J.T @ np.linalg.solve(cov[k], J)
    C = np.linalg.inv(A)
    return 0.5 * (C + C.T)


@kernel
def _roots(cov, share):
    """Lower root of that share of each covariance."""
    L = np.zeros((len(cov), 2, 2))
    for k in range(len(cov)):
        a = np.sqrt(share * cov[k, 0, 0])
        if a > 0.0:
            L[k, 0, 0], L[k, 1, 0] = a, share * cov[k, 1, 0] / a
            L[k, 1, 1] = np.sqrt(max(share * cov[k, 1, 1] - L[k, 1, 0] ** 2, 0.0))
    return L


@kernel
def _times_P(H, L, index, P):
    """H P, with H on r, both attitudes, lasting pose errors and each keypoint's own lasting errors."""
    P15 = np.empty((15, len(P)))
    P15[:3], P15[3:9], P15[9:] = P[:3], P[6:12], P[-6:]
    M = H @ P15
    for k in range(len(index)):
        c = 24 + 2 * index[k]
        for a in range(2):
            for b in range(2):
                if L[k, a, b] != 0.0:
                    M[2 * k + a] += L[k, a, b] * P[c + b]
    return M


@kernel
def _times_Ht(A, H, L, index):
    """A H^T."""
    A15 = np.empty((len(A), 15))
    A15[:, :3], A15[:, 3:9], A15[:, 9:] = A[:, :3], A[:, 6:12], A[:, -6:]
    out = A15 @ H.T
    for k in range(len(index)):
        c = 24 + 2 * index[k]
        for i in range(len(A)):
            out[i, 2 * k] += A[i, c] * L[k, 0, 0] + A[i, c + 1] * L[k, 0, 1]
            out[i, 2 * k + 1] += A[i, c] * L[k, 1, 0] + A[i, c + 1] * L[k, 1, 1]
    return out


@kernel
def _add_noise(S, R):
    for k in range(len(R)):
        for a in range(2):
            for b in range(2):
                S[2 * k + a, 2 * k + b] += R[k, a, b]


@kernel
def _own_errors(x, L, index):
    """Pixels that the points' own lasting errors add."""
    out = np.empty(2 * len(index))
    for k in range(len(index)):
        c = x[26 + 2 * index[k] : 28 + 2 * index[k]]
        out[2 * k] = L[k, 0, 0] * c[0] + L[k, 0, 1] * c[1]
        out[2 * k + 1] = L[k, 1, 0] * c[0] + L[k, 1, 1] * c[1]
    return out


@kernel
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


@kernel
def keypoint_update(x, P, pixels, cov, points, index, R_eci_ric, lens, shares, gate, frame_gates, least_share):
    """(x, P, outcome, accepted keypoints, normalised innovation squared, C) from the keypoints `index` of one frame.

    shares: of the claimed covariance, what lasts of each point by itself, and what is new. Each keypoint is gated by
    itself, then all accepted ones together; far from the truth the update is iterated. C: `pose_covariance` of them.
    """
    used, C = np.zeros(len(points), dtype=np.bool_), np.zeros((6, 6))
    cov = cov[index]
    z, L, R = pixels[index].copy().ravel(), _roots(cov, shares[0]), shares[1] * cov
    h, H = keypoint_model(x, points, index, R_eci_ric, lens)
    S = _times_Ht(_times_P(H, L, index, P), H, L, index)
    _add_noise(S, R)
    keep = _gate(z - h - _own_errors(x, L, index), S, gate)
    m = int(keep.sum())
    if m == 0 or m < least_share * len(index):
        return x, P, DISAGREES if len(index) > 0 else TOO_FEW, used, np.nan, C
    index, cov, L, R = index[keep], cov[keep], L[keep], R[keep]
    z = np.ascontiguousarray(z.reshape(-1, 2)[keep]).ravel()
    e, state, nis = np.zeros(len(P)), x, 0.0
    for turn in range(4):
        h, H = keypoint_model(state, points, index, R_eci_ric, lens)
        if not np.isfinite(h).all():  # the step leads behind the camera: too far to be believed
            return x, P, DISAGREES, used, nis, C
        M = _times_P(H, L, index, P)
        S = _times_Ht(M, H, L, index)
        _add_noise(S, R)
        y = z - h - _own_errors(state, L, index) + _applied(H, L, index, e)
        both = np.linalg.solve(S, np.column_stack((M, y)))
        if turn == 0:
            nis = y @ np.ascontiguousarray(both[:, -1])
            if not nis <= frame_gates[2 * m]:
                return x, P, DISAGREES, used, nis, C
        Kt = np.ascontiguousarray(both[:, :-1])
        before, e = e, Kt.T @ y
        state = corrected(x, e)
        if np.abs(_applied(H, L, index, e - before)).max() < 5.0:  # px: linear enough
            break
    AP = P - Kt.T @ M
    B = _times_Ht(AP, H, L, index)
    for k in range(m):
        B[:, 2 * k : 2 * k + 2] -= Kt[2 * k : 2 * k + 2].T @ R[k]
    out = AP - B @ Kt
    used[index] = True
    C = pose_covariance(H, cov, np.sqrt(x[:3] @ x[:3]))
    return state, reset(_rounded(out, P), e), ACCEPTED, used, nis, C


@kernel
def _applied(H, L, index, e):
    """H e."""
    e15 = np.empty(15)
    e15[:3], e15[3:9], e15[9:] = e[:3], e[6:12], e[-6:]
    out = H @ e15
    for k in range(len(index)):
        c = 24 + 2 * index[k]
        out[2 * k] += L[k, 0, 0] * e[c] + L[k, 0, 1] * e[c + 1]
        out[2 * k + 1] += L[k, 1, 0] * e[c] + L[k, 1, 1] * e[c + 1]
    return out
