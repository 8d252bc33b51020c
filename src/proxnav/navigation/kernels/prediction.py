"""One step of the filter's own dynamics. State layout: proxnav.navigation.layout."""

import math
from typing import no_type_check

import numpy as np
from numba import njit

from proxnav.navigation.kernels.rotations import conjugate, exp, multiply, skew, to_matrix

# Places in the parameter vector that FilterNoise.vector() makes.
(
    ACCELERATION_PSD, SLOW_SIGMA, SLOW_TAU, GYRO_PSD, BIAS_PSD, RATE_PSD, GNSS_SIGMA, GNSS_TAU, CAMERA_TAU, ANGLE_VAR,
) = range(10)  # fmt: skip


@njit(cache=True)
@no_type_check
def advance(x, P, Phi, dt, rate_cam, inertia, noise):
    """(x, P, F, d) after dt seconds: F of the core errors, d the decay of the others.

    rate_cam: measured inertial rate of the camera; inertia: principal moments of the target, zeros where its rate only
    wanders.
    """
    n = len(P)
    w_c = rate_cam - x[17:20]
    w_t = x[14:17].copy()
    E_c, E_t = to_matrix(exp(-dt * w_c)), to_matrix(exp(-dt * w_t))
    M = E_t @ to_matrix(x[10:14]).T  # turn of the camera as an error of the relative attitude
    F = transition(Phi, dt, E_c, E_t, M, w_t, inertia, noise)
    d = decays(n, dt, noise)
    return move(x, Phi, dt, w_c, w_t, inertia, noise), spread(P, F, d, process_noise(dt, M, noise), noise), F, d


@njit(cache=True)
@no_type_check
def transition(Phi, dt, E_c, E_t, M, w_t, inertia, noise):
    """d(core errors after)/d(core errors before)."""
    F = np.zeros((21, 21))
    F[:6, :6] = Phi
    for i in range(3):
        F[i, 18 + i], F[3 + i, 18 + i] = 0.5 * dt * dt, dt
        F[6 + i, 15 + i] = -dt
        F[9 + i, 12 + i], F[12 + i, 12 + i], F[15 + i, 15 + i] = dt, 1.0, 1.0
        F[18 + i, 18 + i] = math.exp(-dt / noise[SLOW_TAU])
    F[6:9, 6:9], F[9:12, 9:12], F[9:12, 15:18] = E_c, E_t, dt * M
    if inertia[0] > 0.0:
        J = np.diag(inertia)
        F[12:15, 12:15] += dt * np.diag(1.0 / inertia) @ (skew(inertia * w_t) - skew(w_t) @ J)
    return F


@njit(cache=True)
@no_type_check
def decays(n, dt, noise):
    """Decay of the errors behind the core."""
    d = np.empty(n - 21)
    d[:3] = math.exp(-dt / noise[GNSS_TAU])
    d[3:] = math.exp(-dt / noise[CAMERA_TAU])
    return d


@njit(cache=True)
@no_type_check
def move(x, Phi, dt, w_c, w_t, inertia, noise):
    """The nominal state after dt."""
    y = x.copy()
    y[:6] = Phi @ x[:6]
    y[:3] += 0.5 * dt * dt * x[20:23]
    y[3:6] += dt * x[20:23]
    y[6:10] = multiply(x[6:10], exp(dt * w_c))
    y[10:14] = multiply(exp(-dt * w_c), multiply(x[10:14], exp(dt * w_t)))
    if inertia[0] > 0.0:
        y[14:17] += dt * np.cross(inertia * w_t, w_t) / inertia
    y[20:23] *= math.exp(-dt / noise[SLOW_TAU])
    y[23:26] *= math.exp(-dt / noise[GNSS_TAU])
    y[26:] *= math.exp(-dt / noise[CAMERA_TAU])
    return y


@njit(cache=True)
@no_type_check
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
        Q[18 + i, 18 + i] = noise[SLOW_SIGMA] ** 2 * (1.0 - keep * keep)
    Q[9:12, 6:9] = -turn * M
    Q[6:9, 9:12] = -turn * M.T
    Q[9:12, 15:18] = 0.5 * u * dt * dt * M
    Q[15:18, 9:12] = 0.5 * u * dt * dt * M.T
    return Q


@njit(cache=True)
@no_type_check
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
        unit = noise[GNSS_SIGMA] if i < 24 else 1.0
        out[i, i] += unit * unit * (1.0 - d[i - 21] ** 2)
    return out


@njit(cache=True)
@no_type_check
def relative_error(x, y):
    """The error vector that leads from state x to state y."""
    e = np.empty(len(x) - 2)
    e[:6] = y[:6] - x[:6]
    e[6:9] = 2.0 * _half_log(x[6:10], y[6:10])
    e[9:12] = 2.0 * _half_log(x[10:14], y[10:14])
    e[12:] = y[14:] - x[14:]
    return e


@njit(cache=True)
@no_type_check
def _half_log(p, q):
    step = multiply(conjugate(p), q)
    sign = -1.0 if step[0] < 0.0 else 1.0
    sine = math.sqrt(step[1] ** 2 + step[2] ** 2 + step[3] ** 2)
    scale = 1.0 if sine < 1e-9 else math.atan2(sine, sign * step[0]) / sine
    return sign * scale * step[1:]


@njit(cache=True)
@no_type_check
def corrected(x, e):
    """State x moved by the error vector e."""
    y = np.empty(len(x))
    y[:6] = x[:6] + e[:6]
    y[6:10] = multiply(x[6:10], exp(e[6:9]))
    y[10:14] = multiply(x[10:14], exp(e[9:12]))
    y[14:] = x[14:] + e[12:]
    return y
