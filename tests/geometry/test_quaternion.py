"""Quaternions: group axioms, SciPy as authority, exactness near 0 and pi."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation, Slerp

from proxnav.geometry import quaternion
from proxnav.geometry.arrays import unit

AXES = arrays(np.float64, 3, elements=st.floats(-1, 1)).filter(lambda v: np.linalg.norm(v) > 1e-2).map(unit)
SPECIAL = st.sampled_from([0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-4, np.pi - 1e-9, np.pi - 1e-5])
ANGLES = st.one_of(st.floats(0.0, np.pi), SPECIAL)
ROTATION_VECTORS = st.builds(lambda axis, angle: axis * angle, AXES, ANGLES)
QUATERNIONS = ROTATION_VECTORS.map(quaternion.exp)
VECTORS = arrays(np.float64, 3, elements=st.floats(-100, 100))


def scipy_of(q):
    return Rotation.from_quat(q, scalar_first=True)


@given(QUATERNIONS, QUATERNIONS, QUATERNIONS)
def test_products_associate(p, q, r):
    left = quaternion.multiply(quaternion.multiply(p, q), r)
    assert left == pytest.approx(quaternion.multiply(p, quaternion.multiply(q, r)), abs=1e-14)


@given(QUATERNIONS)
def test_identity_is_neutral_and_the_conjugate_inverts(q):
    assert quaternion.multiply(quaternion.IDENTITY, q).tolist() == q.tolist()
    assert quaternion.multiply(q, quaternion.conjugate(q)) == pytest.approx(quaternion.IDENTITY, abs=1e-14)


@given(QUATERNIONS, QUATERNIONS, VECTORS)
def test_products_and_rotations_agree_with_scipy(p, q, v):
    assert scipy_of(quaternion.multiply(p, q)).approx_equal(scipy_of(p) * scipy_of(q), atol=1e-9)
    assert quaternion.rotate(p, v) == pytest.approx(scipy_of(p).apply(v), abs=1e-10)
    assert quaternion.to_matrix(p) @ v == pytest.approx(quaternion.rotate(p, v), abs=1e-10)


@given(QUATERNIONS, VECTORS, VECTORS)
def test_rotation_keeps_lengths_and_handedness(q, u, v):
    turned = np.cross(quaternion.rotate(q, u), quaternion.rotate(q, v))
    assert turned == pytest.approx(quaternion.rotate(q, np.cross(u, v)), abs=1e-8)
    assert np.linalg.norm(quaternion.rotate(q, v)) == pytest.approx(np.linalg.norm(v), abs=1e-10)


def test_the_quarter_turn_about_z_by_hand():
    q = np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])
    assert quaternion.rotate(q, np.array([1.0, 0.0, 0.0])) == pytest.approx([0.0, 1.0, 0.0])  # active, Hamilton
    i, j, k = np.eye(4)[1:]
    assert quaternion.multiply(i, j).tolist() == k.tolist()  # JPL's convention would give -k


@given(ROTATION_VECTORS)
def test_log_inverts_exp_up_to_half_a_turn(phi):
    back = quaternion.log(quaternion.exp(phi))
    assert np.linalg.norm(back) <= np.pi + 1e-12
    if np.linalg.norm(phi) < np.pi - 1e-6:
        assert back == pytest.approx(phi, rel=1e-7, abs=1e-15)
    assert quaternion.exp(back) == pytest.approx(quaternion.canonical(quaternion.exp(phi)), abs=1e-12)


@given(AXES, st.sampled_from([1e-12, 1e-10, 1e-8, 2e-9, 1e-6]))
def test_small_rotations_keep_all_their_digits(axis, angle):
    back = quaternion.log(quaternion.exp(axis * angle))
    assert np.linalg.norm(back) == pytest.approx(angle, rel=1e-12)
    assert quaternion.angle_between(quaternion.IDENTITY, quaternion.exp(axis * angle)) == pytest.approx(angle, rel=1e-9)


@given(QUATERNIONS)
def test_q_and_minus_q_are_one_rotation(q):
    assert quaternion.to_matrix(-q) == pytest.approx(quaternion.to_matrix(q), abs=1e-15)
    assert quaternion.canonical(-q) == pytest.approx(quaternion.canonical(q), abs=0.0) or q[0] == 0.0
    assert quaternion.angle_between(q, -q) < 1e-7


@given(QUATERNIONS, QUATERNIONS)
def test_the_angle_between_is_scipys_magnitude_and_symmetric(p, q):
    angle = quaternion.angle_between(p, q)
    assert angle == pytest.approx((scipy_of(p).inv() * scipy_of(q)).magnitude(), abs=1e-7)
    assert angle == pytest.approx(quaternion.angle_between(q, p), abs=1e-12)


@given(QUATERNIONS)
def test_matrices_go_there_and_back(q):
    assert quaternion.from_matrix(quaternion.to_matrix(q)) == pytest.approx(quaternion.canonical(q), abs=1e-7) or (
        abs(q[0]) < 1e-7
    )
    assert quaternion.angle_between(quaternion.from_matrix(quaternion.to_matrix(q)), q) < 1e-7


@given(QUATERNIONS, QUATERNIONS, st.floats(0.0, 1.0))
def test_slerp_agrees_with_scipy_on_the_shorter_arc(p, q, fraction):
    if quaternion.angle_between(p, q) > np.pi - 1e-3:
        return  # the arc is not unique
    reference = Slerp([0.0, 1.0], Rotation.concatenate([scipy_of(p), scipy_of(q)]))(fraction)
    assert scipy_of(quaternion.slerp(p, q, fraction)).approx_equal(reference, atol=1e-8)


@pytest.mark.parametrize("batch", [(), (1,), (5,), (2, 3)])
def test_batches_lead_and_broadcast(batch, rng):
    q = quaternion.normalize(rng.normal(size=(*batch, 4)))
    v = rng.normal(size=(*batch, 3))
    one = quaternion.normalize(rng.normal(size=4))
    assert quaternion.rotate(q, v).shape == (*batch, 3)
    assert quaternion.to_matrix(q).shape == (*batch, 3, 3)
    assert quaternion.from_matrix(quaternion.to_matrix(q)).shape == q.shape
    assert np.shape(quaternion.angle_between(q, q)) == batch
    assert quaternion.rotate(one, v) == pytest.approx(v @ quaternion.to_matrix(one).T)
    assert quaternion.multiply(one, q).shape == q.shape


def test_random_attitudes_are_uniform(rng):
    R = quaternion.to_matrix(quaternion.random(rng, 4000))
    assert np.abs(R.mean(axis=0)).max() < 4.0 * np.sqrt(1.0 / 3.0 / 4000)
    assert np.trace(R, axis1=1, axis2=2).mean() == pytest.approx(0.0, abs=4.0 / np.sqrt(4000))  # Haar measure
