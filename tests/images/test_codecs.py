"""Images written and read back; what is none is refused."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxnav.errors import InputError
from proxnav.images.codecs import encode_png, read_image


def test_a_damaged_image_is_refused(tmp_path):
    (tmp_path / "a.png").write_bytes(encode_png(np.zeros((8, 8), np.uint8))[:40])
    with pytest.raises(InputError, match="not a readable image"):
        read_image(tmp_path / "a.png")


@given(st.sampled_from([np.uint8, np.uint16]), st.sampled_from([(5, 7), (5, 7, 3)]), st.integers(0, 99))
def test_png_keeps_every_value(tmp_path_factory, dtype, shape, seed):
    image = np.random.default_rng(seed).integers(0, np.iinfo(dtype).max, shape, dtype=dtype)
    path = tmp_path_factory.mktemp("png") / "a.png"
    path.write_bytes(encode_png(image))
    np.testing.assert_array_equal(read_image(path), image)


def test_a_picture_of_floating_point_numbers_is_refused(tmp_path):
    cv2.imwrite(str(tmp_path / "radiance.tiff"), np.ones((4, 4), np.float32))
    with pytest.raises(InputError, match="float32"):
        read_image(tmp_path / "radiance.tiff")


def test_sixteen_bit_colour_keeps_its_bits_and_its_order(tmp_path):
    image = np.random.default_rng(1).integers(0, 2**16, (5, 6, 3), dtype=np.uint16)
    (tmp_path / "deep.png").write_bytes(encode_png(image))
    np.testing.assert_array_equal(read_image(tmp_path / "deep.png"), image)
