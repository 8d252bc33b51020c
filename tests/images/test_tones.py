"""Counts of any converter as grey bytes."""

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.images.tones import grey_8_bit


def noise(dtype=np.uint8, shape=(192, 256)):
    return np.random.default_rng(2).integers(0, np.iinfo(dtype).max, shape, dtype=dtype)


@pytest.mark.parametrize(
    "image", [np.zeros((192, 256)), np.zeros((192, 256, 3, 1), np.uint8), np.zeros((0, 5), np.uint8)]
)
def test_an_array_that_is_no_image_is_refused(image):
    with pytest.raises(InputError, match="uint8 or uint16"):
        grey_8_bit(image)


def test_sixteen_bits_read_like_eight():
    image = noise()
    np.testing.assert_array_equal(grey_8_bit(image.astype(np.uint16) << 4, bits=12), image)
