"""The filter's Jacobians against finite differences, and covariances that stay covariances."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from navigation.flights import CAMERA, points
from navigation.orbits import target_at
from proxnav.geometry import quaternion
from proxnav.geometry.relative_motion import cw_transition
from proxnav.navigation.belief import Belief, Scene, nav_state
from proxnav.navigation.config import FilterNoise, NavigationConfig
from proxnav.navigation.errors import normalised_square
from proxnav.navigation.kernels.prediction import advance, corrected, move, relative_error
from proxnav.navigation.kernels.update import joseph, keypoint_model, keypoint_update, reset
from proxnav.navigation.navigator import make_scene
from proxnav.navigation.observe import gnss_model, pose_model

N_CW = 1.13e-3  # rad/s
NONE = np.zeros(3)


def a_state(seed: int, camera_errors: int = 48) -> np.ndarray:
    """A state at 20 m to 40 m before the camera, turned anyhow."""
    rng = np.random.default_rng(seed)
    x = np.zeros(26 + camera_errors)
    x[:3] = rng.normal(size=3)
    x[:3] *= rng.uniform(20.0, 40.0) / np.linalg.norm(x[:3])
    x[3:6] = 0.05 * rng.normal(size=3)
    x[10:14] = quaternion.random(rng, 1)[0]
    x[14:17], x[17:20] = 1e-2 * rng.normal(size=3), 1e-4 * rng.normal(size=3)
    x[20:23], x[23:26] = 1e-6 * rng.normal(size=3), rng.normal(size=3)
    x[26:] = rng.normal(size=camera_errors)
    x[6:10] = looking_at_target(x[:3])
    return x


def looking_at_target(r_ric: np.ndarray) -> np.ndarray:
    """Camera attitude, with RIC axes as the inertial ones."""
    z = -r_ric / np.linalg.norm(r_ric)
    up = np.cross(z, [0.3, 0.5, 0.81])
    x = up / np.linalg.norm(up)
    return quaternion.from_matrix(np.stack([x, np.cross(z, x), z], axis=-1))


def a_covariance(seed: int, n: int = 72) -> np.ndarray:
    rng = np.random.default_rng(seed)
    scale = np.concatenate([np.full(3, 0.3), np.full(3, 1e-3), np.full(6, 1e-2), np.full(3, 1e-4), np.full(3, 1e-5),
                            np.full(3, 1e-6), np.full(3, 0.3), np.ones(n - 24)])  # fmt: skip
    A = rng.normal(size=(n, n)) / np.sqrt(n) + 0.3 * np.eye(n)
    return (A @ A.T) * np.outer(scale, scale)


def scene(config: NavigationConfig | None = None) -> Scene:
    t = np.arange(0.0, 100.0, 10.0)
    states = [target_at(0.0, 1.13e-3 * s) for s in t]
    ephemeris = (t, np.array([r for r, _ in states]), np.array([v for _, v in states]))
    return make_scene(ephemeris, points(), CAMERA, config or NavigationConfig(), True)


def numerical(f, n: int, step: np.ndarray) -> np.ndarray:
    """Central differences of f(error vector)."""
    columns = [(f(step * e) - f(-step * e)) / (2.0 * step[i]) for i, e in enumerate(np.eye(n))]
    return np.stack(columns, axis=1)


STEPS = np.concatenate([np.full(3, 1e-3), np.full(3, 1e-5), np.full(6, 1e-5), np.full(3, 1e-6), np.full(3, 1e-6),
                        np.full(3, 1e-6), np.full(3, 1e-3), np.full(48, 1e-3)])  # fmt: skip


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("inertia", [NONE, np.array([1.0, 3.0, 3.2])])
def test_transition_is_the_derivative_of_the_motion(seed: int, inertia: np.ndarray) -> None:
    x, dt, noise = a_state(seed), 0.5, FilterNoise().vector(True)
    Phi, rate = cw_transition(N_CW, dt), np.array([1e-3, -2e-3, 5e-4])
    _, _, F, d = advance(x, a_covariance(seed), Phi, dt, rate, inertia, noise)

    def moved(e: np.ndarray) -> np.ndarray:
        y = corrected(x, e)
        nominal = move(x, Phi, dt, rate - x[17:20], x[14:17], inertia, noise)
        return relative_error(nominal, move(y, Phi, dt, rate - y[17:20], y[14:17], inertia, noise))

    whole = np.zeros((72, 72))
    whole[:21, :21], whole[range(21, 72), range(21, 72)] = F, d
    scale = np.outer(1.0 / STEPS, STEPS)  # compare in the units of the steps
    # Rates move the attitude by J_r(w dt) dt, not dt: 1 % for the 0.02 rad that the target turns meanwhile.
    np.testing.assert_allclose(numerical(moved, 72, STEPS) * scale, whole * scale, atol=2e-2, rtol=1e-2)


@pytest.mark.parametrize("seed", range(5))
def test_keypoint_jacobian_is_the_derivative_of_the_projection(seed: int) -> None:
    x, s = a_state(seed), scene()
    R, index = np.eye(3), np.arange(24)
    _, H9 = keypoint_model(x, s.points_m, index, R, s.lens)

    def pixels(e: np.ndarray) -> np.ndarray:
        return keypoint_model(corrected(x, e), s.points_m, index, R, s.lens)[0]

    found = numerical(pixels, 72, STEPS)
    np.testing.assert_allclose(
        found[:, [0, 1, 2, 6, 7, 8, 9, 10, 11]], H9, rtol=1e-4, atol=1e-2
    )  # px per m, px per rad
    np.testing.assert_allclose(np.delete(found, [0, 1, 2, 6, 7, 8, 9, 10, 11], axis=1), 0.0, atol=1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_predicted_pixels_are_the_cameras(seed: int) -> None:
    x, s = a_state(seed), scene()
    h, _ = keypoint_model(x, s.points_m, np.arange(24), s.orbit(3.0)[2], s.lens)
    x[6:10] = quaternion.multiply(quaternion.from_matrix(s.orbit(3.0)[2]), x[6:10])
    h, _ = keypoint_model(x, s.points_m, np.arange(24), s.orbit(3.0)[2], s.lens)
    state = nav_state(Belief(3.0, x, a_covariance(0)), s)
    assert state is not None
    cam = quaternion.rotate(state.q_cam_target, s.points_m) + state.t_cam_target_m
    np.testing.assert_allclose(h.reshape(-1, 2), CAMERA.project(cam), atol=1e-9)  # px


@pytest.mark.parametrize("seed", range(3))
def test_gnss_and_pose_jacobians_are_derivatives(seed: int) -> None:
    x, s = a_state(seed), scene()
    H, _ = gnss_model(x, 72, s, 5.0)
    found = numerical(lambda e: gnss_model(corrected(x, e), 72, s, 5.0)[1], 72, STEPS)
    np.testing.assert_allclose(found, H, atol=1e-4)  # m per rad and alike
    H, _ = pose_model(x, 72, s.orbit(5.0)[2])
    found = numerical(lambda e: pose_model(corrected(x, e), 72, s.orbit(5.0)[2])[1], 72, STEPS)
    np.testing.assert_allclose(found, H[:3], atol=1e-4)

    def turned(e: np.ndarray) -> np.ndarray:
        return quaternion.log(quaternion.multiply(corrected(x, e)[10:14], quaternion.conjugate(x[10:14])))

    np.testing.assert_allclose(numerical(turned, 72, STEPS), H[3:], atol=1e-6)


def test_correcting_by_the_error_between_two_states_leads_from_one_to_the_other() -> None:
    x, y = a_state(1), a_state(2)
    back = corrected(x, relative_error(x, y))
    np.testing.assert_allclose(quaternion.canonical(back[6:10]), quaternion.canonical(y[6:10]), atol=1e-12)
    np.testing.assert_allclose(back[:6], y[:6], atol=1e-9)


def test_joseph_update_is_the_textbook_one() -> None:
    rng, P = np.random.default_rng(0), a_covariance(0)
    H, R, y = rng.normal(size=(6, 72)), np.diag(rng.uniform(0.5, 2.0, 6)), rng.normal(size=6)
    e, found, nis = joseph(P, H, R, y)
    S = H @ P @ H.T + R
    np.testing.assert_allclose(e, P @ H.T @ np.linalg.solve(S, y), rtol=1e-8, atol=1e-12)
    np.testing.assert_allclose(found, P - P @ H.T @ np.linalg.solve(S, H @ P), rtol=1e-6, atol=1e-12)
    assert abs(nis - y @ np.linalg.solve(S, y)) < 1e-9


def test_keypoint_update_equals_the_dense_joseph_update() -> None:
    s, x, P = scene(), a_state(4), 1e-4 * a_covariance(4)  # little doubt: one iteration
    R_eci_ric, index = np.eye(3), np.arange(24)
    h, H9 = keypoint_model(x, s.points_m, index, R_eci_ric, s.lens)
    share, sigma = 0.5, 1.2
    root = np.sqrt(share) * sigma
    rng = np.random.default_rng(0)
    z = h + root * x[26:] + 0.5 * rng.normal(size=48)
    cov = np.tile(sigma**2 * np.eye(2), (24, 1, 1))
    args = (z.reshape(24, 2), cov, s.points_m, index, R_eci_ric, s.lens, share, 1e9, s.frame_gates, 0.5)
    x1, P1, _, used, _ = keypoint_update(x, P, *args)
    assert used.all()
    H = np.zeros((48, 72))
    H[:, [0, 1, 2, 6, 7, 8, 9, 10, 11]], H[:, 24:] = H9, root * np.eye(48)
    e, dense, _ = joseph(P, H, (1.0 - share) * sigma**2 * np.eye(48), z - h - root * x[26:])
    np.testing.assert_allclose(relative_error(x, x1), e, rtol=1e-6, atol=1e-12)
    scale = np.sqrt(np.diagonal(P))
    np.testing.assert_allclose(P1 / np.outer(scale, scale), reset(dense, e) / np.outer(scale, scale), atol=1e-9)


@given(
    st.integers(0, 10_000),
    st.floats(1e-6, 1e3),
    st.floats(1e-2, 1e3),
    st.lists(st.booleans(), min_size=24, max_size=24),
)
@settings(max_examples=60, deadline=None)
def test_covariance_stays_symmetric_and_positive(seed: int, doubt: float, sigma_px: float, seen: list[bool]) -> None:
    s, x, P, rng = scene(), a_state(seed), doubt * a_covariance(seed), np.random.default_rng(seed)
    noise = FilterNoise().vector(True)
    for _ in range(4):
        x, P, _, _ = advance(x, P, cw_transition(N_CW, 1.0), 1.0, NONE, NONE, noise)
        h, _ = keypoint_model(x, s.points_m, np.arange(24), np.eye(3), s.lens)
        index = np.flatnonzero(np.array(seen) & np.isfinite(h.reshape(-1, 2)[:, 0]))
        z = h.reshape(-1, 2) + sigma_px * rng.normal(size=(24, 2))
        cov = np.tile(sigma_px**2 * np.eye(2), (24, 1, 1))
        x, P, *_ = keypoint_update(
            x, P, z, cov, s.points_m, index, np.eye(3), s.lens, 0.5, 1e12, np.full(60, 1e12), 0.0
        )
        assert np.array_equal(P, P.T)
        scale = np.sqrt(np.diagonal(P))
        assert (scale > 0.0).all()
        assert np.linalg.eigvalsh(P / np.outer(scale, scale)).min() > 0.0
        assert np.isfinite(x).all()


@given(st.integers(0, 1000))
@settings(max_examples=20, deadline=None)
def test_noise_of_one_step_is_positive(seed: int) -> None:
    x, P0 = a_state(seed), np.zeros((72, 72))
    _, Q, _, _ = advance(x, P0, cw_transition(N_CW, 0.7), 0.7, NONE, NONE, FilterNoise().vector(True))
    scale = np.sqrt(np.diagonal(Q))
    assert np.linalg.eigvalsh(Q / np.outer(scale, scale)).min() > -1e-12


def test_nees_of_a_one_sigma_error_is_one() -> None:
    assert abs(normalised_square(np.array([0.0, 3.0]), np.diag([1e-12, 9.0])) - 1.0) < 1e-12


def test_a_state_before_the_first_pose_is_none() -> None:
    assert nav_state(Belief(0.0), scene()) is None
    assert replace(Belief(0.0), is_lost=True).status(NavigationConfig()) == "lost"
