"""Pixels, calibrations and poses mean the same on both sides."""

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("cyclonedds", reason="Cyclone DDS is not installed: pip install cyclonedds")

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.images.codecs import encode_jpeg, encode_png
from proxnav.live.ros2 import conversions
from proxnav.live.ros2 import messages as ros
from proxnav.viewing.replay.mcap_export import camera_info

GREY = np.arange(48, dtype=np.uint8).reshape(6, 8)
CAMERA = Camera(width=8, height=6, fx=10.0, fy=11.0, cx=4.2, cy=2.9, distortion=(0.1, -0.02, 0.001, 0.002, 0.0))


def raw(image: np.ndarray, encoding: str, padding: int = 0, big: int = 0) -> ros.Image:
    rows = image.reshape(image.shape[0], -1).view(np.uint8)
    rows = np.pad(rows, ((0, 0), (0, padding)))
    height, width = image.shape[:2]
    return ros.Image(ros.Header(), height, width, encoding, big, rows.shape[1], rows.tobytes())


@pytest.mark.parametrize("padding", [0, 3])
def test_a_raw_image_is_read_row_by_row(padding: int) -> None:
    np.testing.assert_array_equal(conversions.pixels_of(raw(GREY, "mono8", padding)), GREY)


def test_bgr_becomes_rgb() -> None:
    colour = np.arange(144, dtype=np.uint8).reshape(6, 8, 3)
    np.testing.assert_array_equal(conversions.pixels_of(raw(colour, "bgr8")), colour[..., ::-1])
    np.testing.assert_array_equal(conversions.pixels_of(raw(colour, "rgb8")), colour)


@pytest.mark.parametrize(("order", "big"), [("<u2", 0), (">u2", 1)])
def test_sixteen_bits_are_read_in_either_byte_order(order: str, big: int) -> None:
    deep = (257 * GREY.astype(np.uint16)).astype(order)
    found = conversions.pixels_of(raw(deep, "mono16", big=big))
    assert found is not None
    assert found.dtype == np.uint16
    np.testing.assert_array_equal(found, 257 * GREY.astype(np.uint16))


@pytest.mark.parametrize("encoded", [encode_png(GREY), encode_jpeg(GREY, 100)])
def test_compressed_images_are_decoded(encoded: bytes) -> None:
    found = conversions.pixels_of(ros.CompressedImage(ros.Header(), "png", encoded))
    assert found is not None
    np.testing.assert_allclose(found.astype(int), GREY, atol=3)


@pytest.mark.parametrize(
    "message",
    [
        ros.Image(ros.Header(), 6, 8, "mono8", 0, 8, bytes(40)),  # truncated
        ros.Image(ros.Header(), 6, 8, "mono8", 0, 7, bytes(48)),  # rows that cannot be
        ros.Image(ros.Header(), 0, 0, "mono8", 0, 0, bytes(1)),
        ros.Image(ros.Header(), 6, 8, "bayer_rggb8", 0, 8, bytes(48)),
        ros.CompressedImage(ros.Header(), "jpeg", encode_jpeg(GREY, 90)[:20]),
    ],
)
def test_what_is_no_picture_is_refused_in_one_sentence(message: ros.Image | ros.CompressedImage) -> None:
    with pytest.raises(InputError, match=r"damaged|bayer_rggb8"):
        conversions.pixels_of(message)


def test_a_message_without_bytes_is_no_picture() -> None:
    assert conversions.pixels_of(ros.Image()) is None


def test_the_calibration_of_our_own_export_reads_back_with_corner_origin_pixels() -> None:
    fields = camera_info(CAMERA)
    info = ros.CameraInfo(ros.Header(), **(fields | {"roi": ros.RegionOfInterest(**fields["roi"])}))
    assert info.k[2] == pytest.approx(CAMERA.cx - 0.5)  # ROS counts from the centre of the first pixel
    found = conversions.camera_of(info)
    np.testing.assert_allclose(
        [found.fx, found.fy, found.cx, found.cy, *found.distortion],
        [CAMERA.fx, CAMERA.fy, CAMERA.cx, CAMERA.cy, *CAMERA.distortion],
    )


def test_an_uncalibrated_camera_is_refused() -> None:
    with pytest.raises(InputError, match="all zeros"):
        conversions.camera_of(ros.CameraInfo(ros.Header(), 6, 8, "plumb_bob"))


def test_a_pose_keeps_its_meaning_and_rows_of_covariance() -> None:
    T = Pose.from_wxyz("cam", "target", [0.5, 0.5, -0.5, 0.5], [1.0, 2.0, 3.0])
    covariance = np.arange(36.0).reshape(6, 6)
    said = conversions.stamped_pose(
        SimpleNamespace(T_cam_target=T, covariance=covariance),
        ros.Header(ros.Time(7, 8), "camera_optical_frame"),  # type: ignore[arg-type]
    )
    assert (said.header.stamp.sec, said.header.frame_id) == (7, "camera_optical_frame")
    assert (said.pose.pose.position.z, said.pose.pose.orientation.w, said.pose.pose.orientation.y) == (3.0, 0.5, -0.5)
    assert said.pose.covariance[6:8] == [6.0, 7.0]
