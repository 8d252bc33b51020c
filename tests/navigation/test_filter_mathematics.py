"""The filter's Jacobians against finite differences, and covariances that stay covariances."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import solve_discrete_lyapunov

from navigation.flights import CAMERA, TIGHT, points
from navigation.orbits import target_at
from proxnav.geometry import quaternion
from proxnav.geometry.mahalanobis import squared_mahalanobis
from proxnav.geometry.relative_motion import cw_transition
from proxnav.navigation.belief import Belief, Scene, nav_state
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.kernels.prediction import (
    advance,
    corrected,
    held_acceleration,
    held_motion,
    move,
    relative_error,
)
from proxnav.navigation.kernels.update import gnss_model, joseph, keypoint_model, keypoint_update, reset
from proxnav.navigation.navigator import make_scene
from proxnav.navigation.observe import pose_model

N_CW = 1.13e-3  # rad/s
NONE = np.zeros(3)
FREE = np.zeros((5, 3))
NO_ERRORS = np.zeros((6, 6))
NOISE = TIGHT.noise_vector(True)
SEEN = [0, 1, 2, 6, 7, 8, 9, 10, 11, *range(72, 78)]
"""Errors that keypoints and poses see, the keypoints' own apart."""


def a_state(seed: int, camera_errors: int = 54) -> np.ndarray:
    """A state at 20 m to 40 m before the camera, turned anyhow."""
    rng = np.random.default_rng(seed)
    x = np.zeros(26 + camera_errors)
    x[:3] = rng.normal(size=3)
    x[:3] *= rng.uniform(20.0, 40.0) / np.linalg.norm(x[:3])
    x[3:6] = 0.05 * rng.normal(size=3)
    x[10:14] = quaternion.random(rng, 1)[0]
    x[14:17], x[17:20] = 1e-2 * rng.normal(size=3), 1e-4 * rng.normal(size=3)
    x[20:23], x[23:26] = 1e-6 * rng.normal(size=3), rng.normal(size=3)
    x[26:-6] = rng.normal(size=camera_errors - 6)
    x[-6:-3], x[-3:] = 0.3 * rng.normal(size=3), 0.02 * rng.normal(size=3)
    x[6:10] = looking_at_target(x[:3])
    return x


def looking_at_target(r_ric: np.ndarray) -> np.ndarray:
    """Camera attitude, with RIC axes as the inertial ones."""
    z = -r_ric / np.linalg.norm(r_ric)
    up = np.cross(z, [0.3, 0.5, 0.81])
    x = up / np.linalg.norm(up)
    return quaternion.from_matrix(np.stack([x, np.cross(z, x), z], axis=-1))


def a_covariance(seed: int, n: int = 78) -> np.ndarray:
    rng = np.random.default_rng(seed)
    scale = np.concatenate([np.full(3, 0.3), np.full(3, 1e-3), np.full(6, 1e-2), np.full(3, 1e-4), np.full(3, 1e-5),
                            np.full(3, 1e-6), np.full(3, 0.3), np.ones(n - 30), np.full(3, 0.2),
                            np.full(3, 0.02)])  # fmt: skip
    A = rng.normal(size=(n, n)) / np.sqrt(n) + 0.3 * np.eye(n)
    return (A @ A.T) * np.outer(scale, scale)


def scene(config: NavigationConfig | None = None) -> Scene:
    t = np.arange(0.0, 100.0, 10.0)
    states = [target_at(0.0, 1.13e-3 * s) for s in t]
    ephemeris = (t, np.array([r for r, _ in states]), np.array([v for _, v in states]))
    return make_scene(ephemeris, points(), CAMERA, config or TIGHT, True)


def numerical(f, n: int, step: np.ndarray) -> np.ndarray:
    """Central differences of f(error vector)."""
    columns = [(f(step * e) - f(-step * e)) / (2.0 * step[i]) for i, e in enumerate(np.eye(n))]
    return np.stack(columns, axis=1)


STEPS = np.concatenate([np.full(3, 1e-3), np.full(3, 1e-5), np.full(6, 1e-5), np.full(3, 1e-6), np.full(3, 1e-6),
                        np.full(3, 1e-6), np.full(3, 1e-3), np.full(48, 1e-3), np.full(3, 1e-3),
                        np.full(3, 1e-5)])  # fmt: skip


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", ["wandering", "tumbling", "held"])
def test_transition_is_the_derivative_of_the_motion(seed: int, kind: str) -> None:
    x, dt = a_state(seed), 0.5
    inertia = np.array([1.0, 3.0, 3.2]) if kind == "tumbling" else NONE
    held = FREE
    if kind == "held":
        held = scene().held(3.0)
        near = quaternion.multiply(quaternion.from_matrix(held[:3]), quaternion.exp(np.array([0.004, -0.003, 0.005])))
        x[10:14] = quaternion.multiply(quaternion.conjugate(x[6:10]), near)
        x[14:17] = np.array([1e-4, -1.2e-3, 2e-4])
    Phi, rate = cw_transition(N_CW, dt), np.array([1e-3, -2e-3, 5e-4])
    _, _, F, d = advance(x, a_covariance(seed), Phi, dt, rate, inertia, held, NO_ERRORS, NOISE)

    def moved(e: np.ndarray) -> np.ndarray:
        y = corrected(x, e)
        nominal = move(x, Phi, dt, rate - x[17:20], x[14:17], inertia, held, NOISE)
        return relative_error(nominal, move(y, Phi, dt, rate - y[17:20], y[14:17], inertia, held, NOISE))

    whole = np.zeros((78, 78))
    whole[:21, :21], whole[range(21, 78), range(21, 78)] = F, d
    scale = np.outer(1.0 / STEPS, STEPS)  # compare in the units of the steps
    # Rates move the attitude by J_r(w dt) dt, not dt: 1 % for the 0.02 rad that the target turns meanwhile.
    np.testing.assert_allclose(numerical(moved, 78, STEPS) * scale, whole * scale, atol=2e-2, rtol=1e-2)


def test_control_pulls_a_held_target_back() -> None:
    s, x = scene(), a_state(0)
    held = s.held(3.0)
    turned = np.array([0.01, 0.0, -0.02])
    at = quaternion.multiply(quaternion.from_matrix(held[:3]), quaternion.exp(turned))
    x[10:14] = quaternion.multiply(quaternion.conjugate(x[6:10]), at)
    error, wanted = held_motion(x, held)
    np.testing.assert_allclose(error, turned, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(wanted), s.orbit(3.0)[3], rtol=1e-12)
    x[14:17] = wanted
    np.testing.assert_allclose(held_acceleration(x, held), -(s.config.held.frequency**2) * turned, atol=1e-12)


@pytest.mark.parametrize("dt", [0.5, 1.0])
def test_a_held_target_wanders_as_far_as_it_is_said_to(dt: float) -> None:
    s, x = scene(), a_state(0)
    held = s.held(3.0)
    x[6:10] = np.array([1.0, 0.0, 0.0, 0.0])
    x[10:14] = quaternion.from_matrix(held[:3])
    x[14:17] = held_motion(x, held)[1]
    Phi, P = cw_transition(N_CW, dt), np.zeros((78, 78))
    _, _, F, _ = advance(x, P, Phi, dt, np.zeros(3), NONE, held, NO_ERRORS, TIGHT.noise_vector(True))
    A, q = F[9:15, 9:15], s.config.held.rate_walk**2
    Q = q * np.kron(np.array([[dt**3 / 3.0, dt**2 / 2.0], [dt**2 / 2.0, dt]]), np.eye(3))
    wander = np.sqrt(np.diagonal(solve_discrete_lyapunov(A, Q))[:3])
    np.testing.assert_allclose(np.rad2deg(wander), s.config.held.sigma_deg, rtol=0.01)


@pytest.mark.parametrize("seed", range(5))
def test_keypoint_jacobian_is_the_derivative_of_the_projection(seed: int) -> None:
    x, s = a_state(seed), scene()
    R, index = np.eye(3), np.arange(24)
    _, H = keypoint_model(x, s.points_m, index, R, s.lens)

    def pixels(e: np.ndarray) -> np.ndarray:
        return keypoint_model(corrected(x, e), s.points_m, index, R, s.lens)[0]

    found = numerical(pixels, 78, STEPS)
    exact = [0, 1, 2, 6, 7, 8, 72, 73, 74]
    np.testing.assert_allclose(found[:, exact], H[:, [*range(6), 9, 10, 11]], rtol=1e-4, atol=1e-2)  # px per m, rad
    turns = H[:, 6:9]  # two turns in a row share a column: off by the size of the lasting one, 0.03 rad
    np.testing.assert_allclose(found[:, 9:12], turns, atol=0.1 * np.abs(turns).max())
    np.testing.assert_allclose(found[:, 75:], turns, atol=0.1 * np.abs(turns).max())
    np.testing.assert_allclose(np.delete(found, SEEN, axis=1), 0.0, atol=1e-6)


def test_a_lasting_pose_error_looks_exactly_like_a_pose() -> None:
    x, s = a_state(1), scene()
    _, H = keypoint_model(x, s.points_m, np.arange(24), np.eye(3), s.lens)
    R_cam_ric = quaternion.to_matrix(x[6:10]).T
    np.testing.assert_allclose(H[:, :3], -H[:, 9:12] @ R_cam_ric, atol=1e-9)
    np.testing.assert_array_equal(H[:, 6:9], H[:, 12:])


@pytest.mark.parametrize("seed", range(5))
def test_predicted_pixels_are_the_cameras(seed: int) -> None:
    x, s = a_state(seed), scene()
    h, _ = keypoint_model(x, s.points_m, np.arange(24), s.orbit(3.0)[2], s.lens)
    x[6:10] = quaternion.multiply(quaternion.from_matrix(s.orbit(3.0)[2]), x[6:10])
    x[-6:] = 0.0
    h, _ = keypoint_model(x, s.points_m, np.arange(24), s.orbit(3.0)[2], s.lens)
    state = nav_state(Belief(3.0, x, a_covariance(0)), s)
    assert state is not None
    cam = quaternion.rotate(state.q_cam_target, s.points_m) + state.t_cam_target_m
    np.testing.assert_allclose(h.reshape(-1, 2), CAMERA.project(cam), atol=1e-9)  # px


@pytest.mark.parametrize("seed", range(3))
def test_gnss_and_pose_jacobians_are_derivatives(seed: int) -> None:
    x, s = a_state(seed), scene()
    own, other, rate = np.array([0.1, -0.2, 0.3]), np.array([-2.0, 0.5, -1.2]), np.array([1e-3, 2e-3, -1e-3])
    _, _, R, n = s.orbit(5.0)
    H, _ = gnss_model(x, R, n, rate, own, other)
    found = numerical(lambda e: gnss_model(corrected(x, e), R, n, rate, own, other)[1], 78, STEPS)
    seen = [*range(18), 21, 22, 23]
    np.testing.assert_allclose(found[:, seen], H, atol=1e-4)  # m per rad and alike
    np.testing.assert_allclose(np.delete(found, seen, axis=1), 0.0, atol=1e-9)
    x[-3:] = 0.0  # the two turns of the target share a column
    H, _, q = pose_model(x, R)
    found = numerical(lambda e: pose_model(corrected(x, e), R)[1], 78, STEPS)
    np.testing.assert_allclose(found[:, SEEN], H[:3], atol=1e-4)

    def turned(e: np.ndarray) -> np.ndarray:
        return quaternion.log(quaternion.multiply(quaternion.conjugate(q), pose_model(corrected(x, e), R)[2]))

    np.testing.assert_allclose(numerical(turned, 78, STEPS)[:, SEEN], H[3:], atol=1e-6)


def test_correcting_by_the_error_between_two_states_leads_from_one_to_the_other() -> None:
    x, y = a_state(1), a_state(2)
    back = corrected(x, relative_error(x, y))
    np.testing.assert_allclose(quaternion.canonical(back[6:10]), quaternion.canonical(y[6:10]), atol=1e-12)
    np.testing.assert_allclose(back[:6], y[:6], atol=1e-9)


def test_joseph_update_is_the_textbook_one() -> None:
    rng, P = np.random.default_rng(0), a_covariance(0)
    columns = np.array([0, 1, 2, 9, 10, 11, 40])
    H, R, y = rng.normal(size=(6, 7)), np.diag(rng.uniform(0.5, 2.0, 6)), rng.normal(size=6)
    e, found, nis = joseph(P, columns, H, R, y)
    full = np.zeros((6, 78))
    full[:, columns] = H
    S = full @ P @ full.T + R
    K = P @ full.T @ np.linalg.inv(S)
    A = np.eye(78) - K @ full
    scale = np.sqrt(np.diagonal(P))
    np.testing.assert_allclose(e / scale, K @ y / scale, atol=1e-8)
    np.testing.assert_allclose(
        found / np.outer(scale, scale), (A @ P @ A.T + K @ R @ K.T) / np.outer(scale, scale), atol=1e-9
    )
    assert abs(nis - y @ np.linalg.solve(S, y)) < 1e-9


def test_keypoint_update_equals_the_dense_joseph_update() -> None:
    s, x, P = scene(), a_state(4), 1e-4 * a_covariance(4)  # little doubt: one iteration
    R_eci_ric, index = np.eye(3), np.arange(24)
    h, H15 = keypoint_model(x, s.points_m, index, R_eci_ric, s.lens)
    shares, sigma = np.array([0.4, 0.6]), 1.2
    root = np.sqrt(shares[0]) * sigma
    rng = np.random.default_rng(0)
    z = h + root * x[26:-6] + 0.5 * rng.normal(size=48)
    cov = np.tile(sigma**2 * np.eye(2), (24, 1, 1))
    args = (z.reshape(24, 2), cov, s.points_m, index, R_eci_ric, s.lens, shares, 1e9, s.frame_gates, 0.5)
    x1, P1, _, used, _, C = keypoint_update(x, P, *args)
    assert used.all()
    H = np.zeros((48, 78))
    H[:, SEEN], H[:, 24:72] = H15, root * np.eye(48)
    e, dense, _ = joseph(P, np.arange(78), H, shares[1] * sigma**2 * np.eye(48), z - h - root * x[26:-6])
    np.testing.assert_allclose(relative_error(x, x1), e, rtol=1e-6, atol=1e-12)
    scale = np.sqrt(np.diagonal(P))
    np.testing.assert_allclose(P1 / np.outer(scale, scale), reset(dense, e) / np.outer(scale, scale), atol=1e-9)
    J = keypoint_model(x1, s.points_m, index, R_eci_ric, s.lens)[1][:, 9:]
    np.testing.assert_allclose(C, np.linalg.inv(J.T @ J / sigma**2), rtol=0.05, atol=1e-6)


@given(
    st.integers(0, 10_000),
    st.floats(1e-6, 1e3),
    st.floats(1e-2, 1e3),
    st.lists(st.booleans(), min_size=24, max_size=24),
)
@settings(max_examples=60, deadline=None)
def test_covariance_stays_symmetric_and_positive(seed: int, doubt: float, sigma_px: float, seen: list[bool]) -> None:
    s, x, P, rng = scene(), a_state(seed), doubt * a_covariance(seed), np.random.default_rng(seed)
    errors = np.diag(np.r_[np.full(3, 0.1), np.full(3, 0.01)] ** 2)
    for _ in range(4):
        x, P, _, _ = advance(x, P, cw_transition(N_CW, 1.0), 1.0, NONE, NONE, FREE, errors, NOISE)
        h, _ = keypoint_model(x, s.points_m, np.arange(24), np.eye(3), s.lens)
        shares = np.array([0.1, 0.5])
        index = np.flatnonzero(np.array(seen) & np.isfinite(h.reshape(-1, 2)[:, 0]))
        z = h.reshape(-1, 2) + sigma_px * rng.normal(size=(24, 2))
        cov = np.tile(sigma_px**2 * np.eye(2), (24, 1, 1))
        x, P, *_ = keypoint_update(
            x, P, z, cov, s.points_m, index, np.eye(3), s.lens, shares, 1e12, np.full(60, 1e12), 0.0
        )
        assert np.array_equal(P, P.T)
        scale = np.sqrt(np.diagonal(P))
        assert (scale > 0.0).all()
        assert np.linalg.eigvalsh(P / np.outer(scale, scale)).min() > 0.0
        assert np.isfinite(x).all()


@given(st.integers(0, 1000))
@settings(max_examples=20, deadline=None)
def test_noise_of_one_step_is_positive(seed: int) -> None:
    x, P0 = a_state(seed), np.zeros((78, 78))
    _, Q, _, _ = advance(x, P0, cw_transition(N_CW, 0.7), 0.7, NONE, NONE, FREE, np.eye(6), NOISE)
    scale = np.sqrt(np.diagonal(Q))
    assert np.linalg.eigvalsh(Q / np.outer(scale, scale)).min() > -1e-12


def test_nees_of_a_one_sigma_error_is_one() -> None:
    assert abs(squared_mahalanobis(np.array([0.0, 3.0]), np.diag([1e-12, 9.0])) - 1.0) < 1e-12


def test_a_state_before_the_first_pose_is_none() -> None:
    assert nav_state(Belief(0.0), scene()) is None
    assert replace(Belief(0.0), is_lost=True).status(NavigationConfig()) == "lost"
