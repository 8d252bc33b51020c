"""Boxes of masks and of projected points."""

import numpy as np

from proxnav.geometry import Camera
from proxnav.geometry.boxes import box_in_image, box_of_mask, box_of_points, cut_at_edges


def test_the_box_is_the_outer_edge_of_the_mask():
    mask = np.zeros((10, 12), bool)
    mask[2:5, 3:9] = True
    np.testing.assert_array_equal(box_of_mask(mask), [3, 2, 9, 5])
    assert np.isnan(box_of_mask(np.zeros((3, 3), bool))).all()


CAMERA = Camera(width=100, height=80, fx=100.0, fy=100.0, cx=50.0, cy=40.0)


def test_points_without_an_image_are_left_out_of_the_box():
    pixels = np.array([[20.0, 30.0], [np.nan, np.nan], [60.0, 10.0]])
    np.testing.assert_array_equal(box_of_points(pixels), [20, 10, 60, 30])
    np.testing.assert_array_equal(box_of_points(pixels, np.array([[1.0], [9.0], [5.0]])), [19, 5, 65, 31])
    assert np.isnan(box_of_points(np.full((3, 2), np.nan))).all()


def test_a_box_is_cut_at_the_edges_and_none_where_less_than_a_pixel_is_left():
    pixels = np.array([[-30.0, 30.0], [60.0, 200.0]])
    box = box_in_image(pixels, CAMERA)
    assert box is not None
    np.testing.assert_array_equal(box, [0, 30, 60, 80])
    assert box_in_image(pixels - (60.0, 0.0), CAMERA) is None  # left of the image
    assert box_in_image(pixels - (59.5, 0.0), CAMERA) is None  # half a pixel of it is in
    assert box_in_image(np.full((3, 2), np.nan), CAMERA) is None
    np.testing.assert_array_equal(cut_at_edges(np.array([120.0, 5.0, 130.0, 9.0]), CAMERA), [100, 5, 100, 9])
