"""Vectors."""

import numpy as np
import pytest

from proxnav.geometry.arrays import cross


@pytest.mark.parametrize("shapes", [((3,), (3,)), ((5, 3), (3,)), ((3,), (7, 3)), ((4, 1, 3), (6, 3))])
def test_the_cross_product_is_that_of_numpy_to_the_bit(shapes) -> None:
    rng = np.random.default_rng(0)
    a, b = (rng.normal(size=shape) for shape in shapes)
    np.testing.assert_array_equal(cross(a, b), np.cross(a, b))
