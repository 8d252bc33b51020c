"""Rotation vectors: exponential, logarithm and Jacobian against SciPy and finite differences."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from proxnav.geometry import so3
from proxnav.geometry.arrays import unit

AXES = arrays(np.float64, 3, elements=st.floats(-1, 1)).filter(lambda v: np.linalg.norm(v) > 1e-2).map(unit)
SPECIAL = st.sampled_from([0.0, 1e-12, 1e-9, 9e-5, 1e-4, 1.1e-4, 1e-3, np.pi - 1e-9, np.pi - 1e-5])
ANGLES = st.one_of(st.floats(0.0, np.pi), SPECIAL)
ROTATION_VECTORS = st.builds(lambda axis, angle: axis * angle, AXES, ANGLES)
VECTORS = arrays(np.float64, 3, elements=st.floats(-10, 10))


@given(VECTORS, VECTORS)
def test_skew_is_the_cross_product(u, v):
    assert so3.skew(u) @ v == pytest.approx(np.cross(u, v), abs=1e-12)
    assert so3.skew(u).T.tolist() == (-so3.skew(u)).tolist()


@given(ROTATION_VECTORS)
def test_exp_is_the_matrix_exponential(phi):
    assert so3.exp(phi) == pytest.approx(expm(so3.skew(phi)), abs=1e-12)
    assert so3.exp(phi) == pytest.approx(Rotation.from_rotvec(phi).as_matrix(), abs=1e-12)


@given(ROTATION_VECTORS)
def test_log_inverts_exp(phi):
    R = so3.exp(phi)
    assert so3.exp(so3.log(R)) == pytest.approx(R, abs=1e-7)
    if np.linalg.norm(phi) < np.pi - 1e-4:
        assert so3.log(R) == pytest.approx(phi, rel=1e-7, abs=1e-12)


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (-1, 2, 3)])
@pytest.mark.parametrize("gap", [0.0, 1e-10, 1e-7, 1e-4])
def test_log_keeps_axis_and_angle_at_half_a_turn(axis, gap):
    phi = (np.pi - gap) * unit(np.array(axis, dtype=np.float64))
    back = so3.log(so3.exp(phi))
    assert min(np.abs(back - phi).max(), np.abs(back + phi).max() + (0.0 if gap == 0.0 else np.inf)) < 1e-7


@given(ROTATION_VECTORS)
def test_the_left_jacobian_agrees_with_finite_differences(phi):
    J, h = so3.left_jacobian(phi), 1e-6
    numeric = np.empty((3, 3))
    for k, d in enumerate(np.eye(3) * h):
        ahead, back = so3.exp(phi + d) @ so3.exp(phi).T, so3.exp(phi - d) @ so3.exp(phi).T
        numeric[:, k] = (so3.log(ahead) - so3.log(back)) / (2.0 * h)
    assert pytest.approx(numeric, abs=1e-7) == J


def test_the_left_jacobian_is_continuous_where_its_series_takes_over():
    axis = unit(np.array([1.0, -2.0, 0.5]))
    below, above = so3.left_jacobian(axis * 0.9999999e-4), so3.left_jacobian(axis * 1.0000001e-4)
    assert below == pytest.approx(above, abs=1e-9)


@pytest.mark.parametrize("batch", [(), (1,), (5,)])
def test_batches_lead(batch, rng):
    phi = rng.normal(size=(*batch, 3))
    for function in (so3.skew, so3.exp, so3.left_jacobian):
        assert function(phi).shape == (*batch, 3, 3)
    assert so3.log(so3.exp(phi)).shape == (*batch, 3)
