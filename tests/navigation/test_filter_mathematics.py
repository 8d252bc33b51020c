"""The filter's Jacobians against finite differences, and covariances that stay covariances."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import solve_discrete_lyapunov

from navigation.flights import CAMERA, TIGHT, points
from navigation.orbits import target_at
from proxnav.geometry import quaternion, so3
from proxnav.geometry.mahalanobis import squared_mahalanobis
from proxnav.geometry.perturbation import ROTATION, TRANSLATION
from proxnav.geometry.relative_motion import cw_transition
from proxnav.navigation.belief import Tracking, nav_state
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import Ephemeris, FilterSetup, filter_setup
from proxnav.navigation.kernels.attitude_control import CONTROL, control_acceleration, control_error
from proxnav.navigation.kernels.dynamics import advance, move
from proxnav.navigation.kernels.error_state import corrected, relative_error, reset
from proxnav.navigation.kernels.gnss import gnss_model
from proxnav.navigation.kernels.gravity_gradient import gradient_transition
from proxnav.navigation.kernels.joseph import joseph
from proxnav.navigation.kernels.keypoints import keypoint_model, keypoint_update
from proxnav.navigation.kernels.published import pose_errors, published
from proxnav.navigation.kernels.seen_pose import seen_pose, true_pose
from proxnav.navigation.layout import FRAME, N_CORE, SEEN_BY_GNSS, E, Layout, X
from proxnav.navigation.navigator import Navigator
from proxnav.navigation.process_noise import noise_vector
from proxnav.records import NAV_ERRORS

N_CW = 1.13e-3  # rad/s
NONE = np.zeros(3)
TURNING = (np.eye(3), 0.0, NONE)
"""RIC as the inertial axes, a camera that does not turn."""
FREE = np.zeros((5, 3))
NO_ERRORS = np.zeros((6, 6))
NOISE = noise_vector(TIGHT, has_gyro=True)
LAYOUT = Layout(n_points=24)
N = LAYOUT.n_errors
CONSTANT = LAYOUT.places(E.turn_acceleration, E.geometry)
"""Errors to which a step adds nothing, where a target is held."""
SEEN = LAYOUT.seen_by_pose
"""Errors that keypoints and poses see, the keypoints' own apart."""


def a_state(seed: int) -> np.ndarray:
    """A state at 20 m to 40 m before the camera, turned anyhow."""
    rng = np.random.default_rng(seed)
    x = np.zeros(LAYOUT.n_states)
    x[X.position] = rng.normal(size=3)
    x[X.position] *= rng.uniform(20.0, 40.0) / np.linalg.norm(x[X.position])
    x[X.velocity] = 0.05 * rng.normal(size=3)
    x[X.q_cam_target] = quaternion.random(rng, 1)[0]
    x[X.rate], x[X.gyro_bias] = 1e-2 * rng.normal(size=3), 1e-4 * rng.normal(size=3)
    x[X.acceleration], x[X.gnss_bias] = 1e-6 * rng.normal(size=3), rng.normal(size=3)
    x[X.point_errors] = rng.normal(size=48)
    x[X.pose_translation], x[X.pose_rotation] = 0.3 * rng.normal(size=3), 0.02 * rng.normal(size=3)
    x[X.target_centre], x[X.chaser_centre] = 0.3 * rng.normal(size=3), 0.3 * rng.normal(size=3)
    x[X.misalignment] = 1e-3 * rng.normal(size=3)
    x[X.turn_acceleration] = 1e-5 * rng.normal(size=3)
    x[X.q_eci_cam] = looking_at_target(x[X.position])
    return x


def by_block(n: int, **values: float) -> np.ndarray:
    """A vector of n errors with one value in each block; those of the points' own and of the pose are named too."""
    out = np.ones(n)
    for name, value in values.items():
        out[getattr(E, name)] = value
    return out


def looking_at_target(r_ric: np.ndarray) -> np.ndarray:
    """Camera attitude, with RIC axes as the inertial ones."""
    z = -r_ric / np.linalg.norm(r_ric)
    up = np.cross(z, [0.3, 0.5, 0.81])
    x = up / np.linalg.norm(up)
    return quaternion.from_matrix(np.stack([x, np.cross(z, x), z], axis=-1))


def a_covariance(seed: int, n: int = N) -> np.ndarray:
    rng = np.random.default_rng(seed)
    scale = by_block(
        n, position=0.3, velocity=1e-3, attitudes=1e-2, rate=1e-4, gyro_bias=1e-5, acceleration=1e-6,
        turn_acceleration=1e-6, gnss_bias=0.3, target_centre=0.1, chaser_centre=0.1, misalignment=1e-3, clock=0.1,
        pose_error=0.02,
    )  # fmt: skip
    A = rng.normal(size=(n, n)) / np.sqrt(n) + 0.3 * np.eye(n)
    return (A @ A.T) * np.outer(scale, scale)


def setup(config: NavigationConfig | None = None) -> FilterSetup:
    t = np.arange(0.0, 100.0, 10.0)
    states = [target_at(0.0, 1.13e-3 * s) for s in t]
    ephemeris = Ephemeris(t, np.array([r for r, _ in states]), np.array([v for _, v in states]))
    return filter_setup(ephemeris, points(), CAMERA, config or TIGHT, True)


def numerical(f, n: int, step: np.ndarray) -> np.ndarray:
    """Central differences of f(error vector)."""
    columns = [(f(step * e) - f(-step * e)) / (2.0 * step[i]) for i, e in enumerate(np.eye(n))]
    return np.stack(columns, axis=1)


STEPS = by_block(
    N, position=1e-3, velocity=1e-5, attitudes=1e-5, rate=1e-6, gyro_bias=1e-6, acceleration=1e-6,
    turn_acceleration=1e-6, gnss_bias=1e-3, geometry=1e-5, point_errors=1e-3, pose_error=1e-5,
)  # fmt: skip


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", ["wandering", "tumbling", "held"])
def test_transition_is_the_derivative_of_the_motion(seed: int, kind: str) -> None:
    x, dt = a_state(seed), 0.5
    inertia = np.array([1.0, 3.0, 3.2]) if kind == "tumbling" else NONE
    control = FREE
    if kind == "held":
        control = setup().control(3.0)
        wanted = quaternion.from_matrix(control[CONTROL.R_eci_wanted])
        near = quaternion.multiply(wanted, quaternion.exp(np.array([0.004, -0.003, 0.005])))
        x[X.q_cam_target] = quaternion.multiply(quaternion.conjugate(x[X.q_eci_cam]), near)
        x[X.rate] = np.array([1e-4, -1.2e-3, 2e-4])
    Phi, rate = cw_transition(N_CW, dt), np.array([1e-3, -2e-3, 5e-4])
    _, _, F, d = advance(x, a_covariance(seed), Phi, dt, rate, inertia, control, NO_ERRORS, NOISE)

    def moved(e: np.ndarray) -> np.ndarray:
        y = corrected(x, e)
        nominal = move(x, Phi, dt, rate - x[X.gyro_bias], x[X.rate], inertia, control, NOISE)
        return relative_error(nominal, move(y, Phi, dt, rate - y[X.gyro_bias], y[X.rate], inertia, control, NOISE))

    whole = np.zeros((N, N))
    whole[E.core, E.core], whole[range(N_CORE, N), range(N_CORE, N)] = F, d
    scale = np.outer(1.0 / STEPS, STEPS)  # compare in the units of the steps
    # Rates move the attitude by J_r(w dt) dt, not dt: 1 % for the 0.02 rad that the target turns meanwhile.
    np.testing.assert_allclose(numerical(moved, N, STEPS) * scale, whole * scale, atol=2e-2, rtol=1e-2)


def test_control_pulls_a_held_target_back() -> None:
    s, x = setup(), a_state(0)
    control = s.control(3.0)
    turned = np.array([0.01, 0.0, -0.02])
    at = quaternion.multiply(quaternion.from_matrix(control[CONTROL.R_eci_wanted]), quaternion.exp(turned))
    x[X.q_cam_target] = quaternion.multiply(quaternion.conjugate(x[X.q_eci_cam]), at)
    error, wanted = control_error(x, control)
    np.testing.assert_allclose(error, turned, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(wanted), s.orbit(3.0)[3], rtol=1e-12)
    x[X.rate] = wanted
    np.testing.assert_allclose(control_acceleration(x, control), -(s.config.held.frequency**2) * turned, atol=1e-12)


@pytest.mark.parametrize("dt", [0.5, 1.0])
def test_a_held_target_wanders_as_far_as_it_is_said_to(dt: float) -> None:
    s, x = setup(), a_state(0)
    control = s.control(3.0)
    x[X.q_eci_cam] = np.array([1.0, 0.0, 0.0, 0.0])
    x[X.q_cam_target] = quaternion.from_matrix(control[CONTROL.R_eci_wanted])
    x[X.rate] = control_error(x, control)[1]
    Phi, P = cw_transition(N_CW, dt), np.zeros((N, N))
    _, _, F, _ = advance(x, P, Phi, dt, np.zeros(3), NONE, control, NO_ERRORS, NOISE)
    turning = LAYOUT.places(E.attitude, E.rate)
    A, q = F[np.ix_(turning, turning)], s.config.held.rate_walk**2
    Q = q * np.kron(np.array([[dt**3 / 3.0, dt**2 / 2.0], [dt**2 / 2.0, dt]]), np.eye(3))
    wander = np.sqrt(np.diagonal(solve_discrete_lyapunov(A, Q))[:3])
    np.testing.assert_allclose(np.rad2deg(wander), s.config.held.sigma_deg, rtol=0.01)


@pytest.mark.parametrize("seed", range(5))
def test_keypoint_jacobian_is_the_derivative_of_the_projection(seed: int) -> None:
    x, s = a_state(seed), setup()
    index = np.arange(24)
    _, H = keypoint_model(x, s.points_m, index, TURNING, s.lens)

    def pixels(e: np.ndarray) -> np.ndarray:
        return keypoint_model(corrected(x, e), s.points_m, index, TURNING, s.lens)[0]

    found = numerical(pixels, N, STEPS)
    seen = found[:, SEEN]
    for block in (FRAME.position, FRAME.attitude_cam, FRAME.pose_translation):
        np.testing.assert_allclose(seen[:, block], H[:, block], rtol=1e-4, atol=1e-2)  # px per m, rad
    turns = H[:, FRAME.attitude]  # two turns in a row share a column: off by the size of the lasting one, 0.03 rad
    for block in (FRAME.attitude, FRAME.pose_rotation):
        np.testing.assert_allclose(seen[:, block], turns, atol=0.15 * np.abs(turns).max())
    np.testing.assert_allclose(np.delete(found, SEEN, axis=1), 0.0, atol=1e-6)


def test_a_lasting_pose_error_looks_exactly_like_a_pose() -> None:
    x, s = a_state(1), setup()
    x[X.misalignment] = x[X.target_centre] = 0.0
    _, H = keypoint_model(x, s.points_m, np.arange(24), TURNING, s.lens)
    R_cam_ric = quaternion.to_matrix(x[X.q_eci_cam]).T
    np.testing.assert_allclose(H[:, FRAME.position], -H[:, FRAME.pose_translation] @ R_cam_ric, atol=1e-9)
    np.testing.assert_array_equal(H[:, FRAME.attitude], H[:, FRAME.pose_rotation])


@pytest.mark.parametrize("seed", range(5))
def test_predicted_pixels_are_the_cameras(seed: int) -> None:
    x, s = a_state(seed), setup()
    R = s.R_eci_ric(3.0)
    x[X.q_eci_cam] = quaternion.multiply(quaternion.from_matrix(R), x[X.q_eci_cam])
    x[X.pose_translation] = x[X.pose_rotation] = 0.0
    h, _ = keypoint_model(x, s.points_m, np.arange(24), (R, 0.0, NONE), s.lens)
    state = nav_state(Tracking(3.0, x, a_covariance(0), camera_t=3.0), s)
    cam = quaternion.rotate(state.q_cam_target, s.points_m) + state.t_cam_target_m
    np.testing.assert_allclose(h.reshape(-1, 2), CAMERA.project(cam), atol=1e-9)  # px


@pytest.mark.parametrize("seed", range(3))
def test_gnss_and_pose_jacobians_are_derivatives(seed: int) -> None:
    x, s = a_state(seed), setup()
    own, other, rate = np.array([0.1, -0.2, 0.3]), np.array([-2.0, 0.5, -1.2]), np.array([1e-3, 2e-3, -1e-3])
    _, _, R, n = s.orbit(5.0)
    H, _ = gnss_model(x, R, n, rate, own, other)
    found = numerical(lambda e: gnss_model(corrected(x, e), R, n, rate, own, other)[1], N, STEPS)
    np.testing.assert_allclose(found[:, SEEN_BY_GNSS], H, atol=1e-4)  # m per rad and alike
    np.testing.assert_allclose(np.delete(found, SEEN_BY_GNSS, axis=1), 0.0, atol=1e-9)
    x[X.pose_rotation] = x[X.misalignment] = 0.0  # turns in a row share a column
    H, _, q = seen_pose(x, R, n, rate)
    found = numerical(lambda e: seen_pose(corrected(x, e), R, n, rate)[1], N, STEPS)
    np.testing.assert_allclose(found[:, SEEN], H[TRANSLATION], atol=1e-4)

    def turned(e: np.ndarray) -> np.ndarray:
        return quaternion.log(quaternion.multiply(quaternion.conjugate(q), seen_pose(corrected(x, e), R, n, rate)[2]))

    np.testing.assert_allclose(numerical(turned, N, STEPS)[:, SEEN], H[ROTATION], atol=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_a_late_frame_is_seen_where_the_target_was(seed: int) -> None:
    x, s, late = a_state(seed), setup(), 0.05
    rate = np.array([1e-3, 2e-3, -1e-3])
    x[X.turn_acceleration] = x[X.acceleration] = x[X.pose_rotation] = 0.0
    x[X.q_eci_cam] = quaternion.multiply(quaternion.from_matrix(s.R_eci_ric(3.0)), x[X.q_eci_cam])
    Phi = gradient_transition(*s.ephemeris, 3.0, late)
    after = move(x, Phi, late, rate - x[X.gyro_bias], x[X.rate], NONE, FREE, NOISE)
    after[X.pose_translation], after[X.pose_rotation] = x[X.pose_translation], x[X.pose_rotation]
    _, t, q = seen_pose(x, *s.turning(3.0, rate))
    after[X.clock] = late
    _, t_late, q_late = seen_pose(after, *s.turning(3.0 + late, rate))
    np.testing.assert_allclose(t_late, t, atol=1e-4)  # m
    assert quaternion.angle_between(q, q_late) < 1e-5


@pytest.mark.parametrize("seed", range(3))
def test_what_is_published_follows_from_the_errors_by_its_derivatives(seed: int) -> None:
    x, s, rate = a_state(seed), setup(), np.array([1e-3, 2e-3, -1e-3])
    turning = s.turning(3.0, rate)
    r, v, J = published(x, *turning)

    def moved(e: np.ndarray) -> np.ndarray:
        other = published(corrected(x, e), *turning)
        return np.concatenate([other[0] - r, other[1] - v])

    n = J.shape[1]
    np.testing.assert_allclose(numerical(moved, N, STEPS)[:, :n], J[:6], atol=1e-5)
    t, R = true_pose(x, turning[0])
    G = pose_errors(x, turning[0])
    found = numerical(lambda e: true_pose(corrected(x, e), turning[0])[0] - t, N, STEPS)
    np.testing.assert_allclose(found[:, :n], G[TRANSLATION], atol=0.05)  # m per rad: 40 m times the misalignment
    turns = numerical(lambda e: so3.log(true_pose(corrected(x, e), turning[0])[1] @ R.T), N, STEPS)[:, :n]
    np.testing.assert_allclose(turns, G[ROTATION], atol=1e-3)
    np.testing.assert_allclose(R.T @ turns, J[NAV_ERRORS.attitude], atol=1e-3)


def test_correcting_by_the_error_between_two_states_leads_from_one_to_the_other() -> None:
    x, y = a_state(1), a_state(2)
    back = corrected(x, relative_error(x, y))
    both = quaternion.canonical(back[X.q_eci_cam]), quaternion.canonical(y[X.q_eci_cam])
    np.testing.assert_allclose(*both, atol=1e-12)
    np.testing.assert_allclose(back[X.motion], y[X.motion], atol=1e-9)


def test_joseph_update_is_the_textbook_one() -> None:
    rng, P = np.random.default_rng(0), a_covariance(0)
    columns = np.array([0, 1, 2, 9, 10, 11, 40])
    H, R, y = rng.normal(size=(6, 7)), np.diag(rng.uniform(0.5, 2.0, 6)), rng.normal(size=6)
    e, found, nis = joseph(P, columns, H, R, y)
    full = np.zeros((6, N))
    full[:, columns] = H
    S = full @ P @ full.T + R
    K = P @ full.T @ np.linalg.inv(S)
    A = np.eye(N) - K @ full
    scale = np.sqrt(np.diagonal(P))
    np.testing.assert_allclose(e / scale, K @ y / scale, atol=1e-8)
    np.testing.assert_allclose(
        found / np.outer(scale, scale), (A @ P @ A.T + K @ R @ K.T) / np.outer(scale, scale), atol=1e-9
    )
    assert abs(nis - y @ np.linalg.solve(S, y)) < 1e-9


def test_keypoint_update_equals_the_dense_joseph_update() -> None:
    s, x, P = setup(), a_state(4), 1e-4 * a_covariance(4)  # little doubt: one iteration
    index = np.arange(24)
    h, H15 = keypoint_model(x, s.points_m, index, TURNING, s.lens)
    shares, sigma = np.array([0.4, 0.6]), 1.2
    root = np.sqrt(shares[0]) * sigma
    rng = np.random.default_rng(0)
    z = h + root * x[X.point_errors] + 0.5 * rng.normal(size=48)
    cov = np.tile(sigma**2 * np.eye(2), (24, 1, 1))
    args = (z.reshape(24, 2), cov, s.points_m, index, TURNING, s.lens, shares, 1e9, s.frame_gates)
    x1, P1, _, used, _, C = keypoint_update(x, P, *args)
    assert used.all()
    H = np.zeros((48, N))
    H[:, SEEN], H[:, E.point_errors] = H15, root * np.eye(48)
    e, dense, _ = joseph(P, np.arange(N), H, shares[1] * sigma**2 * np.eye(48), z - h - root * x[X.point_errors])
    np.testing.assert_allclose(relative_error(x, x1), e, rtol=1e-6, atol=1e-12)
    scale = np.sqrt(np.diagonal(P))
    np.testing.assert_allclose(P1 / np.outer(scale, scale), reset(dense, e) / np.outer(scale, scale), atol=1e-9)
    J = keypoint_model(x1, s.points_m, index, TURNING, s.lens)[1][:, FRAME.pose_error]
    np.testing.assert_allclose(C, np.linalg.inv(J.T @ J / sigma**2), rtol=0.05, atol=1e-6)


@given(
    st.integers(0, 10_000),
    st.floats(1e-6, 1e3),
    st.floats(1e-2, 1e3),
    st.lists(st.booleans(), min_size=24, max_size=24),
)
@settings(max_examples=60, deadline=None)
def test_covariance_stays_symmetric_and_positive(seed: int, doubt: float, sigma_px: float, seen: list[bool]) -> None:
    s, x, P, rng = setup(), a_state(seed), doubt * a_covariance(seed), np.random.default_rng(seed)
    errors = np.diag(np.r_[np.full(3, 0.1), np.full(3, 0.01)] ** 2)
    for _ in range(4):
        x, P, _, _ = advance(x, P, cw_transition(N_CW, 1.0), 1.0, NONE, NONE, FREE, errors, NOISE)
        h, _ = keypoint_model(x, s.points_m, np.arange(24), TURNING, s.lens)
        shares = np.array([0.1, 0.5])
        index = np.flatnonzero(np.array(seen) & np.isfinite(h.reshape(-1, 2)[:, 0]))
        z = h.reshape(-1, 2) + sigma_px * rng.normal(size=(24, 2))
        cov = np.tile(sigma_px**2 * np.eye(2), (24, 1, 1))
        x, P, *_ = keypoint_update(x, P, z, cov, s.points_m, index, TURNING, s.lens, shares, 1e12, np.full(60, 1e12))
        assert np.array_equal(P, P.T)
        scale = np.sqrt(np.diagonal(P))
        assert (scale > 0.0).all()
        assert np.linalg.eigvalsh(P / np.outer(scale, scale)).min() > 0.0
        assert np.isfinite(x).all()


@given(st.integers(0, 1000))
@settings(max_examples=20, deadline=None)
def test_noise_of_one_step_is_positive(seed: int) -> None:
    x, P0 = a_state(seed), np.zeros((N, N))
    _, Q, _, _ = advance(x, P0, cw_transition(N_CW, 0.7), 0.7, NONE, NONE, FREE, np.eye(6), NOISE)
    Q = np.delete(np.delete(Q, CONSTANT, axis=0), CONSTANT, axis=1)
    scale = np.sqrt(np.diagonal(Q))
    assert np.linalg.eigvalsh(Q / np.outer(scale, scale)).min() > -1e-12


def test_nees_of_a_one_sigma_error_is_one() -> None:
    assert abs(squared_mahalanobis(np.array([0.0, 3.0]), np.diag([1e-12, 9.0])) - 1.0) < 1e-12


def test_a_state_before_the_first_pose_is_none() -> None:
    navigator = Navigator(setup(), 0.0)
    assert navigator.belief.status == "waiting"
    assert navigator.at(3.0) is None


def test_a_lost_filter_says_so() -> None:
    belief = Tracking(0.0, a_state(0), a_covariance(0), camera_t=0.0)
    assert belief.status == "tracking"
    assert replace(belief, is_lost=True).status == "lost"
