"""One step of the filter's own dynamics: x and P forward in time."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.rotations import exp, multiply, skew, to_matrix
from proxnav.navigation.kernels.attitude_control import control_acceleration, control_error, control_loop
from proxnav.navigation.kernels.blocks import set_diagonal, set_symmetric
from proxnav.navigation.layout import N_CORE, N_FIXED, N_POSE, E, X
from proxnav.navigation.process_noise import (
    ACCELERATION_PSD,
    ANGLE_VAR,
    BIAS_PSD,
    CALIBRATION,
    CAMERA_TAU,
    GNSS_SIGMA,
    GNSS_TAU,
    GYRO_PSD,
    RATE_PSD,
    SLOW_TAU_S,
    SLOW_VARIANCE,
    TURN_SHARE,
)


@kernel
def advance(x, P, Phi, dt, rate_cam, inertia, control, pose_errors, noise):
    """(x, P, F, d) after dt seconds: F of the core errors, d the decay of the others.

    rate_cam: measured inertial rate of the camera; inertia: principal moments of a free target, zeros where its rate
    only wanders; control: how a controlled target is held, see `ControlRows`; pose_errors (6, 6): long-time covariance
    of the lasting pose error; noise: see `noise_vector`.
    """
    w_c = rate_cam - x[X.gyro_bias]
    w_t = x[X.rate].copy()
    w2 = squared_rate(x, P)
    turn_cam, turn = to_matrix(exp(-dt * w_c)), to_matrix(exp(-dt * w_t))
    M = turn @ to_matrix(x[X.q_cam_target]).T  # turn of the camera as an error of the relative attitude
    F = transition(x, Phi, dt, turn_cam, turn, M, w_t, inertia, control)
    set_diagonal(F, E.turn_acceleration, E.turn_acceleration, math.exp(-dt * math.sqrt(w2)))
    d = decays(len(P), dt, noise)
    out = spread(P, F, d, process_noise(dt, M, w2, noise), noise)
    out[E.pose_error, E.pose_error] += (1.0 - d[-1] ** 2) * pose_errors
    y = move(x, Phi, dt, w_c, w_t, inertia, control, noise)
    y[X.turn_acceleration] *= math.exp(-dt * math.sqrt(w2))
    return y, out, F, d


@kernel
def squared_rate(x, P):
    """Expected square of the target's rate [rad^2/s^2], as far as it is known."""
    w2 = x[X.rate] @ x[X.rate]
    for i in range(E.rate.start, E.rate.stop):
        w2 += P[i, i]
    return w2


@kernel
def transition(x, Phi, dt, turn_cam, turn, M, w_t, inertia, control):
    """d(core errors after)/d(core errors before)."""
    F = np.zeros((N_CORE, N_CORE))
    F[E.motion, E.motion] = Phi
    set_diagonal(F, E.position, E.acceleration, 0.5 * dt * dt)
    set_diagonal(F, E.velocity, E.acceleration, dt)
    set_diagonal(F, E.attitude_cam, E.gyro_bias, -dt)
    set_diagonal(F, E.attitude, E.rate, dt)
    set_diagonal(F, E.attitude, E.turn_acceleration, 0.5 * dt * dt)
    set_diagonal(F, E.rate, E.turn_acceleration, dt)
    set_diagonal(F, E.rate, E.rate, 1.0)
    set_diagonal(F, E.gyro_bias, E.gyro_bias, 1.0)
    set_diagonal(F, E.acceleration, E.acceleration, math.exp(-dt / SLOW_TAU_S))
    F[E.attitude_cam, E.attitude_cam], F[E.attitude, E.attitude] = turn_cam, turn
    F[E.attitude, E.gyro_bias] = dt * M
    w0, _ = control_loop(control)
    if w0 > 0.0:
        _add_control(F, x, dt, control)
    elif inertia[0] > 0.0:
        J = np.diag(inertia)
        F[E.rate, E.rate] += dt * np.diag(1.0 / inertia) @ (skew(inertia * w_t) - skew(w_t) @ J)
    return F


@kernel
def _add_control(F, x, dt, control):
    """A and B: derivatives of the angular acceleration that control gives, by attitude and by rate."""
    w0, zeta = control_loop(control)
    damping = 2.0 * zeta * w0
    turn = skew(control_error(x, control)[1])
    A, B = damping * turn - w0 * w0 * np.eye(3), turn - damping * np.eye(3)
    A_cam = A @ to_matrix(x[X.q_cam_target]).T
    F[E.attitude, E.attitude] += 0.5 * dt * dt * A
    F[E.attitude, E.attitude_cam] += 0.5 * dt * dt * A_cam
    F[E.attitude, E.rate] += 0.5 * dt * dt * B
    F[E.rate, E.rate] += dt * B - 0.5 * (dt * w0) ** 2 * np.eye(3)
    F[E.rate, E.attitude], F[E.rate, E.attitude_cam] = dt * A, dt * A_cam


@kernel
def decays(n, dt, noise):
    """Decay of the n errors behind the core in dt seconds."""
    d = np.empty(n - N_CORE)
    d[: N_FIXED - N_CORE] = 1.0
    d[E.gnss_bias.start - N_CORE : E.gnss_bias.stop - N_CORE] = math.exp(-dt / noise[GNSS_TAU])
    d[N_FIXED - N_CORE :] = math.exp(-dt / noise[CAMERA_TAU])
    if noise[CALIBRATION] > 0.0:
        d[E.calibration] = 1.0
    return d


@kernel
def move(x, Phi, dt, w_c, w_t, inertia, control, noise):
    """The nominal state after dt.

    A controlled target's step is of second order: with one of the first the covariance would wander 4.5 % too far.
    """
    y, w_mean = x.copy(), w_t + 0.5 * dt * x[X.turn_acceleration]
    y[X.rate] += dt * x[X.turn_acceleration]
    w0, _ = control_loop(control)
    if w0 > 0.0:
        pull = control_acceleration(x, control)
        w_mean = w_mean + 0.5 * dt * pull
        y[X.rate] += dt * pull - 0.5 * (dt * w0) ** 2 * (w_t - control_error(x, control)[1])
    elif inertia[0] > 0.0:
        y[X.rate] += dt * np.cross(inertia * w_t, w_t) / inertia
    y[X.motion] = Phi @ x[X.motion]
    y[X.position] += 0.5 * dt * dt * x[X.acceleration]
    y[X.velocity] += dt * x[X.acceleration]
    y[X.q_eci_cam] = multiply(x[X.q_eci_cam], exp(dt * w_c))
    y[X.q_cam_target] = multiply(exp(-dt * w_c), multiply(x[X.q_cam_target], exp(dt * w_mean)))
    y[X.acceleration] *= math.exp(-dt / SLOW_TAU_S)
    y[X.gnss_bias] *= math.exp(-dt / noise[GNSS_TAU])
    y[X.camera_errors] *= math.exp(-dt / noise[CAMERA_TAU])
    if noise[CALIBRATION] > 0.0:
        y[X.calibration] = x[X.calibration]
    return y


@kernel
def process_noise(dt, M, w2, noise):
    """Covariance that dt seconds add to the core errors (Q_d of a random walk seen by its integral).

    w2: `squared_rate`. What Euler's equations leave out of the angular acceleration is a share of it, and turns with
    the body.
    """
    Q = np.zeros((N_CORE, N_CORE))
    q, g, u, w = noise[ACCELERATION_PSD], noise[GYRO_PSD], noise[BIAS_PSD], noise[RATE_PSD]
    keep = math.exp(-dt / SLOW_TAU_S)
    turn = g * dt + u * dt**3 / 3.0 + noise[ANGLE_VAR]
    set_diagonal(Q, E.position, E.position, q * dt**3 / 3.0)
    set_diagonal(Q, E.velocity, E.velocity, q * dt)
    set_symmetric(Q, E.position, E.velocity, 0.5 * q * dt * dt)
    set_diagonal(Q, E.attitude_cam, E.attitude_cam, turn)
    set_diagonal(Q, E.attitude, E.attitude, turn + w * dt**3 / 3.0)
    set_symmetric(Q, E.attitude, E.rate, 0.5 * w * dt * dt)
    set_diagonal(Q, E.rate, E.rate, w * dt)
    set_diagonal(Q, E.gyro_bias, E.gyro_bias, u * dt)
    set_symmetric(Q, E.attitude_cam, E.gyro_bias, -0.5 * u * dt * dt)
    slow = noise[SLOW_VARIANCE]
    for i in range(len(slow)):
        Q[E.acceleration.start + i, E.acceleration.start + i] = slow[i] * (1.0 - keep * keep)
    lost = 1.0 - math.exp(-2.0 * dt * math.sqrt(w2))
    set_diagonal(Q, E.turn_acceleration, E.turn_acceleration, (noise[TURN_SHARE] * w2) ** 2 * lost)
    Q[E.attitude, E.attitude_cam] = -turn * M
    Q[E.attitude_cam, E.attitude] = -turn * M.T
    Q[E.attitude, E.gyro_bias] = 0.5 * u * dt * dt * M
    Q[E.gyro_bias, E.attitude] = 0.5 * u * dt * dt * M.T
    return Q


@kernel
def spread(P, F, d, Q, noise):
    """F P F^T + Q, with F dense in the core and diagonal behind it."""
    n = len(P)
    out = np.empty((n, n))
    core = F @ np.ascontiguousarray(P[E.core, E.core]) @ F.T + Q
    out[E.core, E.core] = 0.5 * (core + core.T)
    across = (F @ np.ascontiguousarray(P[E.core, E.fading])) * d
    out[E.core, E.fading] = across
    out[E.fading, E.core] = across.T
    for i in range(N_CORE, n):
        for j in range(N_CORE, n):
            out[i, j] = d[i - N_CORE] * d[j - N_CORE] * P[i, j]
        unit = noise[GNSS_SIGMA] if i < N_FIXED else 1.0 if i < n - N_POSE else 0.0
        out[i, i] += unit * unit * (1.0 - d[i - N_CORE] ** 2)
    return out
