"""Generated trajectories against the mission's published numbers and against two-body motion."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.celestial import MU_EARTH, R_eci_lvlh
from proxnav.geometry.relative_motion import cw_transition, eci_from_ric, ric_from_eci
from proxnav.trajectories import (
    OBSERVATION_10_100,
    OBSERVATION_10_100_STRICT,
    SROC_200_350,
    ApproachConfig,
    FlightConfig,
    HoldConfig,
    OrbitConfig,
    PointingConfig,
    SafetyEllipseConfig,
    ShellConfig,
    clip_range,
    hold,
    random_shell,
    spread,
    straight_approach,
    walking_safety_ellipse,
)
from proxnav.trajectories.orbit import fly_orbit
from proxnav.trajectories.safety_ellipse import ellipse_state, radial_centre_m

ORBIT = OrbitConfig()
N = ORBIT.mean_motion


def two_body(r, v, t):
    """States at `t` by numerical integration of the point-mass field."""

    def field(_, y):
        return np.concatenate([y[3:], -MU_EARTH * y[:3] / np.linalg.norm(y[:3]) ** 3])

    solution = solve_ivp(field, (0.0, t[-1]), np.concatenate([r, v]), "DOP853", t, rtol=1e-12, atol=1e-9)
    return solution.y[:3].T, solution.y[3:].T


def relative(trajectory):
    return ric_from_eci(
        trajectory.r_eci_target_m,
        trajectory.v_eci_target_mps,
        trajectory.r_eci_chaser_m,
        trajectory.v_eci_chaser_mps,
    )


def test_the_orbit_has_the_period_and_rate_of_400_km():
    assert ORBIT.period_s == pytest.approx(5553.6, abs=0.05)
    assert pytest.approx(1.13137e-3, abs=5e-9) == N


def test_the_circular_orbit_is_a_two_body_orbit_of_its_inclination():
    t = np.linspace(0.0, 5000.0, 11)
    orbit = OrbitConfig(inclination_deg=51.6, raan_deg=40.0, argument_of_latitude_deg=100.0)
    r, v = fly_orbit(orbit, t)
    r_num, v_num = two_body(r[0], v[0], t)
    assert np.abs(r - r_num).max() < 1e-3  # m
    assert np.abs(v - v_num).max() < 1e-6  # m/s
    normal = np.cross(r[0], v[0])
    assert np.degrees(np.arccos(normal[2] / np.linalg.norm(normal))) == pytest.approx(51.6)


@pytest.mark.parametrize(
    ("config", "x_c", "ranges", "clearance", "speed", "los_deg_s"),
    [
        (OBSERVATION_10_100, -4.51, (11.1, 116.0), 10.5, 0.045, 0.15),
        (SafetyEllipseConfig(chi0_deg=90.0), -4.51, (10.5, 106.0), 10.5, 0.045, 0.17),
        (OBSERVATION_10_100_STRICT, -3.71, (10.6, 99.1), 10.3, 0.041, 0.15),
    ],
)
def test_the_spiral_has_the_published_numbers(config, x_c, ranges, clearance, speed, los_deg_s):
    trajectory = walking_safety_ellipse(config)
    rho, rho_dot = relative(trajectory)
    assert radial_centre_m(config, N) == pytest.approx(x_c, abs=0.005)
    assert trajectory.range_m.min() == pytest.approx(ranges[0], abs=0.06)
    assert trajectory.range_m.max() == pytest.approx(ranges[1], abs=0.25)
    assert np.linalg.norm(rho[:, [0, 2]], axis=1).min() == pytest.approx(clearance, abs=0.05)
    assert clearance == pytest.approx(config.x_max_m - abs(x_c), abs=0.05)
    assert np.linalg.norm(rho_dot, axis=1).max() == pytest.approx(speed, abs=6e-4)
    los = np.linalg.norm(np.cross(rho, rho_dot), axis=1) / np.sum(rho**2, axis=1)
    assert np.degrees(los.max()) == pytest.approx(los_deg_s, abs=0.005)


def test_the_flown_observation_stays_outside_the_keep_out_sphere():
    trajectory = walking_safety_ellipse(SROC_200_350)
    assert trajectory.range_m.min() > 200.0
    assert trajectory.t[-1] == pytest.approx(8 * 3600.0, abs=10.0)


def test_the_spiral_is_a_clohessy_wiltshire_solution_only_with_the_plus_sign():
    t = np.array([0.0, 3000.0])
    rho, rho_dot = ellipse_state(OBSERVATION_10_100, N, t)
    propagated = cw_transition(N, 3000.0) @ np.concatenate([rho[0], rho_dot[0]])
    assert propagated == pytest.approx(np.concatenate([rho[1], rho_dot[1]]), abs=1e-10)
    misprint = rho_dot[0] - [0.0, 2.0 * OBSERVATION_10_100.ydot_c_mps, 0.0]
    wrong = cw_transition(N, 3000.0) @ np.concatenate([rho[0], misprint])
    assert wrong[1] - rho[1, 1] == pytest.approx(151.0, abs=0.5)  # m in-track


def test_the_spiral_agrees_with_two_body_motion_to_the_linearisation_error():
    trajectory = walking_safety_ellipse(SafetyEllipseConfig(orbits=1.0, step_s=60.0))
    r, v = two_body(trajectory.r_eci_chaser_m[0], trajectory.v_eci_chaser_mps[0], trajectory.t)
    errors = np.linalg.norm(r - trajectory.r_eci_chaser_m, axis=1)
    assert errors.max() < 0.05  # m in one orbit: rho^2 / a = 2 mm, growing by the period's second-order change
    assert np.linalg.norm(v - trajectory.v_eci_chaser_mps, axis=1).max() < 1e-4


@settings(deadline=None)
@given(st.floats(1.0, 6000.0), st.floats(1.0, 6000.0))
def test_transitions_compose(first, second):
    together = cw_transition(N, first + second)
    assert cw_transition(N, second) @ cw_transition(N, first) == pytest.approx(together, rel=1e-9, abs=1e-7)


def test_the_transition_converges_to_two_body_motion_with_the_square_of_the_distance():
    t = np.array([0.0, 1500.0])
    target = fly_orbit(ORBIT, t)
    errors = []
    for scale in (100.0, 10.0):
        state = scale * np.array([1.0, -0.5, 0.7, 2e-3, -1e-3, 1e-3])
        r0, v0 = eci_from_ric(target[0][:1], target[1][:1], state[None, :3], state[None, 3:])
        r, _ = two_body(r0[0], v0[0], t)
        rho = ric_from_eci(target[0][1], target[1][1], r[1], target[1][1])[0]
        errors.append(np.linalg.norm(rho - (cw_transition(N, 1500.0) @ state)[:3]))
    assert np.log10(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


def test_relative_states_survive_the_way_to_eci_and_back(rng):
    target = fly_orbit(ORBIT, np.linspace(0.0, 5000.0, 7))
    rho, rho_dot = rng.normal(size=(7, 3)) * 100.0, rng.normal(size=(7, 3))
    back = ric_from_eci(*target, *eci_from_ric(*target, rho, rho_dot))
    assert back[0] == pytest.approx(rho, abs=1e-8)
    assert back[1] == pytest.approx(rho_dot, abs=1e-10)


def test_the_eclipse_lasts_thirty_six_minutes_an_orbit():
    trajectory = walking_safety_ellipse(SafetyEllipseConfig(step_s=5.0))
    minutes = (1.0 - trajectory.sun_visible).mean() * ORBIT.period_s / 60.0
    assert minutes == pytest.approx(36.0, abs=0.2)


@pytest.mark.parametrize("fly", [walking_safety_ellipse, hold, straight_approach, random_shell])
def test_every_generator_points_the_camera_and_keeps_the_target_lvlh_fixed(fly):
    trajectory = spread(fly(), 25)
    for k in range(len(trajectory)):
        t_cam_target = trajectory.T_cam_target(k).t_m
        assert t_cam_target == pytest.approx([0.0, 0.0, trajectory.range_m[k]], abs=1e-6)
        R_lvlh = R_eci_lvlh(trajectory.r_eci_target_m[k], trajectory.v_eci_target_mps[k])
        assert quaternion.to_matrix(trajectory.q_eci_target[k]) == pytest.approx(R_lvlh, abs=1e-9)


def test_velocities_are_the_derivatives_of_positions():
    trajectory = walking_safety_ellipse(SafetyEllipseConfig(step_s=1.0, orbits=0.02))
    for r, v in (
        (trajectory.r_eci_target_m, trajectory.v_eci_target_mps),
        (trajectory.r_eci_chaser_m, trajectory.v_eci_chaser_mps),
    ):
        central = (r[2:] - r[:-2]) / 2.0
        assert np.abs(central - v[1:-1]).max() < 2e-3  # m/s, n^2 dt^2 v / 6


def test_hold_stays_and_approach_arrives():
    still = hold(HoldConfig(position_m=(3.0, -20.0, 1.0)))
    assert relative(still)[0] == pytest.approx(np.tile([3.0, -20.0, 1.0], (601, 1)), abs=1e-6)
    assert np.abs(relative(still)[1]).max() < 1e-9
    moving = straight_approach(ApproachConfig(start_m=(0.0, -100.0, 5.0), end_m=(0.0, -10.0, 0.0), duration_s=90.0))
    assert relative(moving)[0][[0, -1]] == pytest.approx(np.array([[0, -100, 5], [0, -10, 0]]), abs=1e-6)


def test_the_shell_fills_its_ranges_and_follows_its_seed():
    ranges = np.sort(random_shell(ShellConfig(count=400, seed=1)).range_m)
    assert np.abs((ranges - 10.0) / 90.0 - (np.arange(400) + 0.5) / 400).max() < 1.63 / 20.0
    assert (random_shell(ShellConfig(seed=1)).range_m == random_shell(ShellConfig(seed=1)).range_m).all()
    assert (random_shell(ShellConfig(seed=1)).range_m != random_shell(ShellConfig(seed=2)).range_m).all()


@pytest.mark.parametrize(("up", "axis"), [("zenith", -2), ("forward", 0), ("cross_track", -1)])
def test_the_configured_direction_is_up_in_the_picture(up, axis):
    flight = FlightConfig(pointing=PointingConfig(up=up))
    trajectory = hold(HoldConfig(position_m=(10.0, -20.0, 15.0), duration_s=10.0), flight)
    lvlh = quaternion.to_matrix(trajectory.q_eci_target[0])
    towards = {-2: -lvlh[:, 2], 0: lvlh[:, 0], -1: -lvlh[:, 1]}[axis]
    right, down, _ = quaternion.to_matrix(trajectory.q_eci_cam[0]).T @ towards
    assert abs(right) < 1e-9
    assert down < 0.0


def test_jitter_has_its_size_and_roll_turns_the_picture():
    steady = hold(HoldConfig(duration_s=2000.0, step_s=2.0))
    shaken = hold(HoldConfig(duration_s=2000.0, step_s=2.0), FlightConfig(pointing=PointingConfig(jitter_deg=0.1)))
    angles = quaternion.log(quaternion.multiply(quaternion.conjugate(steady.q_eci_cam), shaken.q_eci_cam))
    assert np.degrees(angles.std(axis=0)) == pytest.approx([0.1] * 3, rel=0.1)
    rolled = hold(flight=FlightConfig(pointing=PointingConfig(roll_deg=30.0)))
    turn = quaternion.multiply(quaternion.conjugate(hold().q_eci_cam[0]), rolled.q_eci_cam[0])
    assert np.degrees(quaternion.log(turn)) == pytest.approx([0.0, 0.0, 30.0], abs=1e-9)


def test_clipping_keeps_only_the_asked_ranges():
    clipped = clip_range(walking_safety_ellipse(), 10.0, 100.0)
    assert clipped.range_m.max() <= 100.0
    assert 0.8 < len(clipped) / len(walking_safety_ellipse()) < 1.0
    with pytest.raises(InputError, match="widen the range"):
        clip_range(walking_safety_ellipse(), 1.0, 2.0)


def test_impossible_parameters_are_refused():
    with pytest.raises(InputError, match="step_s > 0"):
        hold(HoldConfig(step_s=0.0))
    with pytest.raises(InputError, match="altitude_m must be positive"):
        OrbitConfig(altitude_m=-1.0)
    with pytest.raises(InputError, match="0 < least <= most"):
        random_shell(ShellConfig(range_m=(0.0, 5.0)))
