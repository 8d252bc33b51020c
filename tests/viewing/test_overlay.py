"""What is drawn lies where it was found, and what cannot be drawn does no harm."""

import numpy as np
import pytest

from proxnav.geometry import Camera, Pose
from proxnav.records import Keypoints
from proxnav.viewing.overlay import caption, contact_sheet, overlay

CAMERA = Camera(width=200, height=160, fx=300.0, fy=300.0, cx=100.0, cy=80.0)
T = Pose.from_wxyz("cam", "target", [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 10.0])
BLACK = np.zeros((160, 200), np.uint8)


def _found(pixels: list[list[float]], sigma_px: float = 4.0) -> Keypoints:
    n = len(pixels)
    return Keypoints(
        "ok", np.array(pixels), np.tile(np.eye(2) * sigma_px**2, (n, 1, 1)), np.ones(n), np.full(4, np.nan)
    )


def _middle(drawn: np.ndarray) -> np.ndarray:
    """Centre of all that is not black [px], corner origin."""
    rows, columns = np.nonzero(drawn.any(axis=2))
    return np.array([columns.min() + columns.max() + 1, rows.min() + rows.max() + 1]) / 2


@pytest.mark.parametrize("pixel", [[60.5, 40.5], [100.0, 80.0], [150.25, 120.75]])
def test_an_ellipse_lies_about_its_keypoint_and_is_three_sigma_wide(pixel: list[float]) -> None:
    drawn = overlay(BLACK, CAMERA, keypoints=_found([pixel]))
    np.testing.assert_allclose(_middle(drawn), pixel, atol=0.75)  # px
    width = np.ptp(np.nonzero(drawn.any(axis=(0, 2)))[0])
    assert 2 * 3 * 4.0 <= width <= 2 * 3 * 4.0 + 3.0  # px; the line and its soft edge add up to three


def test_true_keypoints_are_crosses_where_they_project() -> None:
    point = np.array([[1.0, -0.5, 0.0]])  # at (130, 65) px
    with_cross = overlay(BLACK, CAMERA, T_true=T, points_target_m=point, axis_m=1.0).astype(int)
    cross = np.abs(with_cross - overlay(BLACK, CAMERA, T_true=T, axis_m=1.0)).astype(np.uint8)
    np.testing.assert_allclose(_middle(cross), [130.5, 65.5], atol=0.6)


def test_the_estimated_axes_point_along_the_body() -> None:
    drawn = overlay(BLACK, CAMERA, T_estimate=T, axis_m=1.0)
    assert drawn[80, 115].argmax() == 0  # x to the right, red
    assert drawn[95, 100].argmax() == 1  # y down, green


def test_what_lies_outside_or_is_not_a_number_is_left_out() -> None:
    behind = Pose.from_wxyz("cam", "target", [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -5.0])
    drawn = overlay(BLACK, CAMERA, behind, behind, np.eye(3), _found([[np.nan, np.nan], [1e9, 0.0]]))
    assert drawn.shape == (160, 200, 3)
    assert not drawn.any()


def test_the_image_given_is_not_drawn_upon() -> None:
    image = np.zeros((160, 200, 3), np.uint8)
    caption(overlay(image, CAMERA, T, T), ["a line"])
    assert not image.any()


def test_images_of_sixteen_bits_keep_their_order_of_brightness() -> None:
    image = np.tile(np.linspace(0, 4095, 200).astype(np.uint16), (160, 1))
    shown = overlay(image, CAMERA)[0, :, 0]
    assert (np.diff(shown.astype(int)) >= 0).all()
    assert shown[-1] == 255


def test_a_contact_sheet_is_filled_up_with_black() -> None:
    sheet = contact_sheet([np.full((10, 10), 200, np.uint8)] * 5, columns=4, side=32)
    assert sheet.shape == (64, 128, 3)
    assert not sheet[32:, 32:].any()
