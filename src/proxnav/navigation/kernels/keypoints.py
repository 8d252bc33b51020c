"""A frame of keypoints into the state, in Joseph form; gated one by one and all together."""

import numpy as np

from proxnav.geometry.calibration import N_CALIBRATION
from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.rotations import skew, to_matrix
from proxnav.geometry.perturbation import ROTATION, TRANSLATION
from proxnav.navigation.gates import LEAST_SHARE
from proxnav.navigation.kernels.blocks import set_diagonal
from proxnav.navigation.kernels.error_state import corrected, reset
from proxnav.navigation.kernels.joseph import rounded
from proxnav.navigation.kernels.seen_pose import seen_pose
from proxnav.navigation.layout import FRAME, N_POSE, E, X

FX, FY, CX, CY, SIGMA_FOCAL, SIGMA_PRINCIPAL = range(6)
"""Places in the lens of a camera without distortion: [px], and what is not known of them."""
LASTING, NEW = range(2)
"""Places in the shares of the claimed covariance: what lasts of each point by itself, and what is new."""

_N_SEEN = FRAME.pose_error.stop
_POINTS_X, _POINTS_E = X.point_errors.start, E.point_errors.start


@kernel
def keypoint_model(x, points, index, turning, lens):
    """(predicted pixels, H) of the points `index`; NaN behind the camera.

    turning: (R_eci_ric, its rate n [rad/s], measured rate of the camera [rad/s]). The detector sees the target where
    `seen_pose` says. Where errors of the calibration are states, their columns follow those of `FRAME`.
    """
    known = lens[SIGMA_FOCAL] == 0.0 and lens[SIGMA_PRINCIPAL] == 0.0
    stretch, shift_x, shift_y = 1.0, 0.0, 0.0
    if not known:
        off = x[X.calibration]
        stretch += lens[SIGMA_FOCAL] * off[0]
        shift_x, shift_y = lens[SIGMA_PRINCIPAL] * off[1], lens[SIGMA_PRINCIPAL] * off[2]
    fx, fy = lens[FX] * stretch, lens[FY] * stretch
    H_pose, t, q = seen_pose(x, turning[0], turning[1], turning[2])
    R_ct, m = to_matrix(q), len(index)
    z, H = np.empty(2 * m), np.zeros((2 * m, _N_SEEN if known else _N_SEEN + N_CALIBRATION))
    J = np.zeros((2, N_POSE))
    for k in range(m):
        p = points[index[k]]
        c = R_ct @ p + t
        z_k, H_k = z[2 * k : 2 * k + 2], H[2 * k : 2 * k + 2]
        if c[2] < 0.1:
            z_k[:] = np.nan
            continue
        z_k[0] = fx * c[0] / c[2] + lens[CX] + shift_x
        z_k[1] = fy * c[1] / c[2] + lens[CY] + shift_y
        J[0, 0], J[0, 2] = fx / c[2], -fx * c[0] / c[2] ** 2
        J[1, 1], J[1, 2] = fy / c[2], -fy * c[1] / c[2] ** 2
        J[:, ROTATION] = -np.ascontiguousarray(J[:, TRANSLATION]) @ (R_ct @ skew(p))
        H_k[:, :_N_SEEN] = J @ H_pose
        if not known:
            H_k[0, _N_SEEN] = lens[SIGMA_FOCAL] * lens[FX] * c[0] / c[2]
            H_k[1, _N_SEEN] = lens[SIGMA_FOCAL] * lens[FY] * c[1] / c[2]
            H_k[0, _N_SEEN + 1] = H_k[1, _N_SEEN + 2] = lens[SIGMA_PRINCIPAL]
    return z, H


@kernel
def pose_covariance(H, cov, distance):
    """Covariance of the least-squares pose of keypoints with the covariances `cov`: dt in camera, dr in target axes.

    A frame of few points has no such pose: what any pose in view has bounds it.
    """
    A = np.zeros((6, 6))
    set_diagonal(A, TRANSLATION, TRANSLATION, 1.0 / (0.3 * distance) ** 2)
    set_diagonal(A, ROTATION, ROTATION, 4.0)
    for k in range(len(cov)):
        J = np.ascontiguousarray(H[2 * k : 2 * k + 2, FRAME.pose_error])
        A += J.T @ np.linalg.solve(cov[k], J)
    C = np.linalg.inv(A)
    return 0.5 * (C + C.T)


@kernel
def keypoint_update(x, P, pixels, cov, points, index, turning, lens, shares, gate, frame_gates):
    """(x, P, whether accepted, accepted keypoints, normalised innovation squared, C) from the keypoints `index`.

    shares: of the claimed covariance, see `LASTING` and `NEW`. Each keypoint is gated by itself, then all accepted ones
    together; far from the truth the update is iterated. C: `pose_covariance` of them.
    """
    used, C = np.zeros(len(points), dtype=np.bool_), np.zeros((6, 6))
    cov = cov[index]
    z, L, R = pixels[index].copy().ravel(), _roots(cov, shares[LASTING]), shares[NEW] * cov
    keep = _agreeing(x, P, z, L, R, points, index, turning, lens, gate)
    m = int(keep.sum())
    if m == 0 or m < LEAST_SHARE * len(index):
        return x, P, False, used, np.nan, C
    index, cov, L, R = index[keep], cov[keep], L[keep], R[keep]
    z = np.ascontiguousarray(z.reshape(-1, 2)[keep]).ravel()
    e, state, nis = np.zeros(len(P)), x, 0.0
    for turn in range(4):
        h, H = keypoint_model(state, points, index, turning, lens)
        if not np.isfinite(h).all():  # the step leads behind the camera: too far to be believed
            return x, P, False, used, nis, C
        M = _times_P(H, L, index, P)
        S = _times_Ht(M, H, L, index)
        _add_noise(S, R)
        y = z - h - _own_errors(state, L, index) + _applied(H, L, index, e)
        both = np.linalg.solve(S, np.column_stack((M, y)))
        if turn == 0:
            nis = y @ np.ascontiguousarray(both[:, -1])
            if not nis <= frame_gates[2 * m]:
                return x, P, False, used, nis, C
        Kt = np.ascontiguousarray(both[:, :-1])
        before, e = e, Kt.T @ y
        state = corrected(x, e)
        if np.abs(_applied(H, L, index, e - before)).max() < 5.0:  # px: linear enough
            break
    used[index] = True
    C = pose_covariance(H, cov, np.sqrt(x[X.position] @ x[X.position]))
    return state, reset(_joseph(P, Kt, M, H, L, R, index), e), True, used, nis, C


@kernel
def _joseph(P, Kt, M, H, L, R, index):
    """(I - K H) P (I - K H)^T + K R K^T, with M = H P."""
    AP = P - Kt.T @ M
    B = _times_Ht(AP, H, L, index)
    for k in range(len(index)):
        B[:, 2 * k : 2 * k + 2] -= Kt[2 * k : 2 * k + 2].T @ R[k]
    return rounded(AP - B @ Kt, P)


@kernel
def _agreeing(x, P, z, L, R, points, index, turning, lens, gate):
    """Which keypoints lie within their own 2x2 innovation covariance."""
    h, H = keypoint_model(x, points, index, turning, lens)
    S = _times_Ht(_times_P(H, L, index, P), H, L, index)
    _add_noise(S, R)
    y = z - h - _own_errors(x, L, index)
    keep = np.zeros(len(index), dtype=np.bool_)
    for k in range(len(index)):
        a, b, c = S[2 * k, 2 * k], S[2 * k, 2 * k + 1], S[2 * k + 1, 2 * k + 1]
        u, v = y[2 * k], y[2 * k + 1]
        d2 = (c * u * u - 2.0 * b * u * v + a * v * v) / (a * c - b * b)
        keep[k] = d2 <= gate  # False for NaN
    return keep


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
    """H P, with H on what a frame sees and each keypoint's own lasting errors."""
    seen = np.empty((H.shape[1], len(P)))
    seen[FRAME.position], seen[FRAME.attitudes] = P[E.position], P[E.attitudes]
    seen[FRAME.geometry], seen[FRAME.pose_error] = P[E.geometry], P[E.pose_error]
    if H.shape[1] > _N_SEEN:
        seen[_N_SEEN:] = P[E.calibration]
    M = H @ seen
    for k in range(len(index)):
        c = _POINTS_E + 2 * index[k]
        for a in range(2):
            for b in range(2):
                if L[k, a, b] != 0.0:
                    M[2 * k + a] += L[k, a, b] * P[c + b]
    return M


@kernel
def _times_Ht(A, H, L, index):
    """A H^T."""
    seen = np.empty((len(A), H.shape[1]))
    seen[:, FRAME.position], seen[:, FRAME.attitudes] = A[:, E.position], A[:, E.attitudes]
    seen[:, FRAME.geometry], seen[:, FRAME.pose_error] = A[:, E.geometry], A[:, E.pose_error]
    if H.shape[1] > _N_SEEN:
        seen[:, _N_SEEN:] = A[:, E.calibration]
    out = seen @ H.T
    for k in range(len(index)):
        c = _POINTS_E + 2 * index[k]
        for i in range(len(A)):
            out[i, 2 * k] += A[i, c] * L[k, 0, 0] + A[i, c + 1] * L[k, 0, 1]
            out[i, 2 * k + 1] += A[i, c] * L[k, 1, 0] + A[i, c + 1] * L[k, 1, 1]
    return out


@kernel
def _applied(H, L, index, e):
    """H e."""
    seen = np.empty(H.shape[1])
    seen[FRAME.position], seen[FRAME.attitudes] = e[E.position], e[E.attitudes]
    seen[FRAME.geometry], seen[FRAME.pose_error] = e[E.geometry], e[E.pose_error]
    if H.shape[1] > _N_SEEN:
        seen[_N_SEEN:] = e[E.calibration]
    out = H @ seen
    for k in range(len(index)):
        c = _POINTS_E + 2 * index[k]
        out[2 * k] += L[k, 0, 0] * e[c] + L[k, 0, 1] * e[c + 1]
        out[2 * k + 1] += L[k, 1, 0] * e[c] + L[k, 1, 1] * e[c + 1]
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
        c = x[_POINTS_X + 2 * index[k] : _POINTS_X + 2 * index[k] + 2]
        out[2 * k] = L[k, 0, 0] * c[0] + L[k, 0, 1] * c[1]
        out[2 * k + 1] = L[k, 1, 0] * c[0] + L[k, 1, 1] * c[1]
    return out
