"""Rodrigues parameters and quaternions say the same attitude."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from proxnav.geometry import quaternion
from proxnav.live.basilisk.attitude import q_n_b, sigma_bn, sigma_by_turn

seeds = st.integers(0, 2**32 - 1)


@given(seeds)
def test_parameters_are_those_of_scipy(seed: int) -> None:
    q = quaternion.canonical(quaternion.random(np.random.default_rng(seed), 1)[0])
    np.testing.assert_allclose(sigma_bn(q), Rotation.from_quat(q, scalar_first=True).as_mrp(), atol=1e-12)


@given(seeds)
def test_there_and_back_is_the_same_attitude(seed: int) -> None:
    q = quaternion.random(np.random.default_rng(seed), 1)[0]
    assert quaternion.angle_between(q, q_n_b(sigma_bn(q))) < 1e-7  # rad


def test_a_quarter_turn_about_z_takes_x_of_the_body_to_y() -> None:
    q = q_n_b(np.array([0.0, 0.0, np.tan(np.pi / 8.0)]))
    np.testing.assert_allclose(quaternion.rotate(q, np.array([1.0, 0.0, 0.0])), [0.0, 1.0, 0.0], atol=1e-12)


@given(seeds)
def test_the_derivative_is_that_of_small_turns(seed: int) -> None:
    rng = np.random.default_rng(seed)
    sigma = rng.uniform(-0.5, 0.5, 3)
    turn = 1e-6 * rng.normal(size=3)
    moved = sigma_bn(quaternion.multiply(q_n_b(sigma), quaternion.exp(turn)))
    np.testing.assert_allclose(moved - sigma, sigma_by_turn(sigma) @ turn, atol=1e-11)
