"""Windowed polynomials against SciPy's and against functions they must reproduce."""

import numpy as np
import pytest
from scipy.interpolate import KroghInterpolator

from proxnav.trajectories.readers.polynomials import polynomials


def test_one_window_is_scipys_interpolation(rng):
    tn, yn = np.cumsum(rng.uniform(5.0, 15.0, 6)), rng.normal(size=(6, 3))
    t = np.linspace(tn[0], tn[-1], 13)
    value, slope = polynomials(tn, yn, None, t, 6)
    reference = KroghInterpolator(tn, yn)
    assert value == pytest.approx(reference(t), abs=1e-9)
    assert slope == pytest.approx(reference.derivative(t), abs=1e-9)


def test_with_slopes_it_is_scipys_hermite_interpolation(rng):
    tn, yn, dy = np.arange(0.0, 40.0, 10.0), rng.normal(size=(4, 2)), rng.normal(size=(4, 2))
    t = np.linspace(0.0, 30.0, 17)
    value, slope = polynomials(tn, yn, dy, t, 4)
    reference = KroghInterpolator(np.repeat(tn, 2), np.stack([yn, dy], axis=1).reshape(8, 2))
    assert value == pytest.approx(reference(t), abs=1e-8)
    assert slope == pytest.approx(reference.derivative(t), abs=1e-8)


@pytest.mark.parametrize("nodes", [2, 3, 6, 9])
def test_polynomials_of_their_degree_are_exact_everywhere(nodes, rng):
    truth = np.polynomial.Polynomial(rng.normal(size=nodes))
    tn, t = np.linspace(0.0, 3.0, 25), rng.uniform(0.0, 3.0, 50)
    value, slope = polynomials(tn, truth(tn)[:, None], None, t, nodes)
    assert value[:, 0] == pytest.approx(truth(t), rel=1e-9, abs=1e-6)
    assert slope[:, 0] == pytest.approx(truth.deriv()(t), rel=1e-6, abs=1e-4)


def test_fewer_points_than_nodes_use_them_all():
    value, slope = polynomials(np.array([0.0, 1.0]), np.array([[0.0], [2.0]]), None, np.array([0.25]), 6)
    assert (value[0, 0], slope[0, 0]) == (0.5, 2.0)
