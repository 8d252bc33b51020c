"""Squares turned by quarters."""

import numpy as np
import pytest

from proxnav.images.quarter_turns import turned, turned_back


@pytest.mark.parametrize("quarters", [0, 1, 2, 3])
def test_what_is_found_in_a_turned_image_comes_back_to_where_it_was(quarters: int) -> None:
    image = np.zeros((9, 9))
    image[2, 5] = 1.0
    row, column = np.argwhere(turned(image, quarters))[0]
    along_x = np.diag([4.0, 1.0])[None]
    found, covariance = turned_back(np.array([[column + 0.5, row + 0.5]]), along_x, 9, quarters)
    np.testing.assert_allclose(found, [[5.5, 2.5]])
    np.testing.assert_allclose(covariance[0], np.diag([4.0, 1.0] if quarters % 2 == 0 else [1.0, 4.0]), atol=1e-12)
