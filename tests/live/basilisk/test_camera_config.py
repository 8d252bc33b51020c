"""A CameraConfigMsg as a camera of ours, and where it sits."""

from types import SimpleNamespace

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.geometry import Camera, quaternion
from proxnav.live.basilisk.attitude import sigma_bn
from proxnav.live.basilisk.camera_config import camera_of, field_of_view, mounting_of


def test_the_field_of_view_is_that_of_the_height_and_pixels_are_square() -> None:
    camera = camera_of(SimpleNamespace(resolution=[1920, 1200], fieldOfView=np.deg2rad(22.0)))
    assert (camera.width, camera.height, camera.cx, camera.cy) == (1920, 1200, 960.0, 600.0)
    assert camera.fx == camera.fy == pytest.approx(600.0 / np.tan(np.deg2rad(11.0)))
    top = camera.project(np.array([0.0, -np.tan(np.deg2rad(11.0)), 1.0]))
    np.testing.assert_allclose(top, [960.0, 0.0], atol=1e-9)  # the upper edge of the first row


def test_a_field_of_view_gives_back_its_camera() -> None:
    camera = Camera(width=640, height=480, fx=700.0, fy=700.0, cx=320.0, cy=240.0)
    assert camera_of(SimpleNamespace(resolution=[640, 480], fieldOfView=field_of_view(camera))).fx == pytest.approx(700)


@pytest.mark.parametrize("other", [{"fy": 710.0}, {"cx": 321.0}, {"distortion": (0.1, 0.0, 0.0, 0.0)}])
def test_cameras_that_the_message_cannot_describe_are_refused(other: dict) -> None:
    given = {"width": 640, "height": 480, "fx": 700.0, "fy": 700.0, "cx": 320.0, "cy": 240.0}
    with pytest.raises(InputError, match="resample"):
        field_of_view(Camera(**(given | other)))


def test_an_unwritten_message_is_refused_in_one_sentence() -> None:
    with pytest.raises(InputError, match="resolution"):
        camera_of(SimpleNamespace(resolution=[0, 0], fieldOfView=0.0))


def test_sigma_cb_turns_body_components_into_camera_components() -> None:
    q_body_cam = np.array([0.5, -0.5, 0.5, -0.5])  # looks along +x of the body, y of the image is -z
    mounting = mounting_of(SimpleNamespace(cameraPos_B=[0.1, 0.0, 0.2], sigma_CB=sigma_bn(q_body_cam)))
    np.testing.assert_allclose(mounting.in_cam(np.array([1.0, 0.0, 0.0])), [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(mounting.in_cam(np.array([0.0, 0.0, -1.0])), [0.0, 1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(mounting.q_eci_cam(quaternion.IDENTITY), q_body_cam, atol=1e-12)
