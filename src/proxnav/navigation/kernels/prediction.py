"""One step of the filter's own dynamics. State layout: proxnav.navigation.layout."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.rotations import conjugate, exp, multiply, skew, to_matrix

# Places in the parameter vector that NavigationConfig.noise_vector() makes.
(
    ACCELERATION_PSD, SLOW_X, SLOW_Y, SLOW_Z, SLOW_TAU, GYRO_PSD, BIAS_PSD, RATE_PSD, GNSS_SIGMA, GNSS_TAU, CAMERA_TAU,
    ANGLE_VAR,
) = range(12)  # fmt: skip


@kernel
def advance(x, P, Phi, dt, rate_cam, inertia, held, pose_errors, noise):
    """(x, P, F, d) after dt seconds: F of the core errors, d the decay of the others.

    rate_cam: measured inertial rate of the camera; inertia: principal moments of a free target, zeros where its rate
    only wanders; held (5, 3): how a controlled target is held, see `held_motion`, zeros for a free one; pose_errors
    (6, 6): long-time covariance of the lasting pose error.
    """
    n = len(P)
    w_c = rate_cam - x[17:20]
    w_t = x[14:17].copy()
    E_c, E_t = to_matrix(exp(-dt * w_c)), to_matrix(exp(-dt * w_t))
    M = E_t @ to_matrix(x[10:14]).T  # turn of the camera as an error of the relative attitude
    F = transition(x, Phi, dt, E_c, E_t, M, w_t, inertia, held, noise)
    d = decays(n, dt, noise)
    out = spread(P, F, d, process_noise(dt, M, noise), noise)
    out[-6:, -6:] += (1.0 - d[-1] ** 2) * pose_errors
    return move(x, Phi, dt, w_c, w_t, inertia, held, noise), out, F, d


@kernel
def held_motion(x, held):
    """(error of a held target's attitude, wanted rate in target axes).

    held: rows 0-2 R_eci_held of the attitude that control holds, row 3 its inertial rate in its own axes, row 4 natural
    frequency [rad/s] and damping of the control loop.
    """
    R = np.ascontiguousarray(held[:3]).T @ to_matrix(multiply(x[6:10], x[10:14]))
    return _log_matrix(R), R.T @ np.ascontiguousarray(held[3])


@kernel
def _log_matrix(R):
    """Rotation vector of a matrix, for turns below half a turn."""
    v = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine = math.sqrt(v @ v)
    if sine < 1e-12:
        return v
    return v * (math.atan2(sine, 0.5 * (R[0, 0] + R[1, 1] + R[2, 2] - 1.0)) / sine)


@kernel
def held_acceleration(x, held):
    """Angular acceleration of a held target: w0^2 and 2 zeta w0 pull attitude and rate back to what is wanted."""
    error, wanted = held_motion(x, held)
    w0, zeta = held[4, 0], held[4, 1]
    excess = x[14:17] - wanted
    return -w0 * w0 * error - 2.0 * zeta * w0 * excess + np.cross(wanted, excess)


@kernel
def transition(x, Phi, dt, E_c, E_t, M, w_t, inertia, held, noise):
    """d(core errors after)/d(core errors before)."""
    F = np.zeros((21, 21))
    F[:6, :6] = Phi
    for i in range(3):
        F[i, 18 + i], F[3 + i, 18 + i] = 0.5 * dt * dt, dt
        F[6 + i, 15 + i] = -dt
        F[9 + i, 12 + i], F[12 + i, 12 + i], F[15 + i, 15 + i] = dt, 1.0, 1.0
        F[18 + i, 18 + i] = math.exp(-dt / noise[SLOW_TAU])
    F[6:9, 6:9], F[9:12, 9:12], F[9:12, 15:18] = E_c, E_t, dt * M
    if held[4, 0] > 0.0:
        w0, damping = held[4, 0], 2.0 * held[4, 1] * held[4, 0]
        turn = skew(held_motion(x, held)[1])
        A, B = damping * turn - w0 * w0 * np.eye(3), turn - damping * np.eye(3)
        A_cam = A @ to_matrix(x[10:14]).T
        F[9:12, 9:12] += 0.5 * dt * dt * A
        F[9:12, 6:9] += 0.5 * dt * dt * A_cam
        F[9:12, 12:15] += 0.5 * dt * dt * B
        F[12:15, 12:15] += dt * B - 0.5 * (dt * w0) ** 2 * np.eye(3)
        F[12:15, 9:12], F[12:15, 6:9] = dt * A, dt * A_cam
    elif inertia[0] > 0.0:
        J = np.diag(inertia)
        F[12:15, 12:15] += dt * np.diag(1.0 / inertia) @ (skew(inertia * w_t) - skew(w_t) @ J)
    return F


@kernel
def decays(n, dt, noise):
    """Decay of the errors behind the core."""
    d = np.empty(n - 21)
    d[:3] = math.exp(-dt / noise[GNSS_TAU])
    d[3:] = math.exp(-dt / noise[CAMERA_TAU])
    return d


@kernel
def move(x, Phi, dt, w_c, w_t, inertia, held, noise):
    """The nominal state after dt.

    A held target's step is of second order: with one of the first the covariance would wander 4.5 % too far.
    """
    y, w_mean = x.copy(), w_t
    if held[4, 0] > 0.0:
        pull = held_acceleration(x, held)
        w_mean = w_t + 0.5 * dt * pull
        y[14:17] += dt * pull - 0.5 * (dt * held[4, 0]) ** 2 * (w_t - held_motion(x, held)[1])
    y[:6] = Phi @ x[:6]
    y[:3] += 0.5 * dt * dt * x[20:23]
    y[3:6] += dt * x[20:23]
    y[6:10] = multiply(x[6:10], exp(dt * w_c))
    y[10:14] = multiply(exp(-dt * w_c), multiply(x[10:14], exp(dt * w_mean)))
    if held[4, 0] == 0.0 and inertia[0] > 0.0:
        y[14:17] += dt * np.cross(inertia * w_t, w_t) / inertia
    y[20:23] *= math.exp(-dt / noise[SLOW_TAU])
    y[23:26] *= math.exp(-dt / noise[GNSS_TAU])
    y[26:] *= math.exp(-dt / noise[CAMERA_TAU])
    return y


@kernel
def process_noise(dt, M, noise):
    """Covariance that dt seconds add to the core errors (Q_d of a random walk seen by its integral)."""
    Q = np.zeros((21, 21))
    q, g, u, w = noise[ACCELERATION_PSD], noise[GYRO_PSD], noise[BIAS_PSD], noise[RATE_PSD]
    keep = math.exp(-dt / noise[SLOW_TAU])
    turn = g * dt + u * dt**3 / 3.0 + noise[ANGLE_VAR]
    for i in range(3):
        Q[i, i], Q[3 + i, 3 + i] = q * dt**3 / 3.0, q * dt
        Q[i, 3 + i] = Q[3 + i, i] = 0.5 * q * dt * dt
        Q[6 + i, 6 + i] = turn
        Q[9 + i, 9 + i] = turn + w * dt**3 / 3.0
        Q[9 + i, 12 + i] = Q[12 + i, 9 + i] = 0.5 * w * dt * dt
        Q[12 + i, 12 + i], Q[15 + i, 15 + i] = w * dt, u * dt
        Q[6 + i, 15 + i] = Q[15 + i, 6 + i] = -0.5 * u * dt * dt
        Q[18 + i, 18 + i] = noise[SLOW_X + i] ** 2 * (1.0 - keep * keep)
    Q[9:12, 6:9] = -turn * M
    Q[6:9, 9:12] = -turn * M.T
    Q[9:12, 15:18] = 0.5 * u * dt * dt * M
    Q[15:18, 9:12] = 0.5 * u * dt * dt * M.T
    return Q


@kernel
def spread(P, F, d, Q, noise):
    """F P F^T + Q, with F dense in the core and diagonal behind it."""
    n = len(P)
    out = np.empty((n, n))
    core = F @ np.ascontiguousarray(P[:21, :21]) @ F.T + Q
    out[:21, :21] = 0.5 * (core + core.T)
    across = (F @ np.ascontiguousarray(P[:21, 21:])) * d
    out[:21, 21:] = across
    out[21:, :21] = across.T
    for i in range(21, n):
        for j in range(21, n):
            out[i, j] = d[i - 21] * d[j - 21] * P[i, j]
        unit = noise[GNSS_SIGMA] if i < 24 else 1.0 if i < n - 6 else 0.0
        out[i, i] += unit * unit * (1.0 - d[i - 21] ** 2)
    return out


@kernel
def relative_error(x, y):
    """The error vector that leads from state x to state y."""
    e = np.empty(len(x) - 2)
    e[:6] = y[:6] - x[:6]
    e[6:9] = 2.0 * _half_log(x[6:10], y[6:10])
    e[9:12] = 2.0 * _half_log(x[10:14], y[10:14])
    e[12:] = y[14:] - x[14:]
    return e


@kernel
def _half_log(p, q):
    step = multiply(conjugate(p), q)
    sign = -1.0 if step[0] < 0.0 else 1.0
    sine = math.sqrt(step[1] ** 2 + step[2] ** 2 + step[3] ** 2)
    scale = 1.0 if sine < 1e-9 else math.atan2(sine, sign * step[0]) / sine
    return sign * scale * step[1:]


@kernel
def corrected(x, e):
    """State x moved by the error vector e."""
    y = np.empty(len(x))
    y[:6] = x[:6] + e[:6]
    y[6:10] = multiply(x[6:10], exp(e[6:9]))
    y[10:14] = multiply(x[10:14], exp(e[9:12]))
    y[14:] = x[14:] + e[12:]
    return y
