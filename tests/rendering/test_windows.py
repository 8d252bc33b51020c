"""The target's window holds its image and no more than a margin around it."""

import numpy as np
import pytest
import trimesh

from proxnav.geometry import Camera, Pose
from proxnav.records import Window
from proxnav.rendering.windows import MARGIN_PX, target_window

CAMERA = Camera(200, 100, 300.0, 300.0, 100.0, 50.0)
WHOLE = Window(0, 0, 200, 100)
CUBE = np.asarray(trimesh.creation.box((1.0, 1.0, 1.0)).vertices)


def test_it_is_the_box_of_the_vertices_with_a_margin():
    T = Pose.from_wxyz("cam", "target", [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 10.5])
    # the near face is at 10 m: 300 * 0.5 / 10 = 15 px to each side
    m = MARGIN_PX
    assert target_window(CUBE, T, CAMERA, WHOLE) == Window(85 - m, 35 - m, 30 + 2 * m, 30 + 2 * m)


def test_it_is_clipped_to_what_was_asked():
    T = Pose.from_wxyz("cam", "target", [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 10.5])
    assert target_window(CUBE, T, CAMERA, Window(90, 40, 10, 5)) == Window(90, 40, 10, 5)


def test_it_is_empty_beside_and_behind_the_camera():
    for t_m in ([50.0, 0.0, 10.0], [0.0, 0.0, -10.0]):
        T = Pose.from_wxyz("cam", "target", [1.0, 0.0, 0.0, 0.0], t_m)
        assert target_window(CUBE, T, CAMERA, WHOLE).width == 0


def test_a_target_around_the_camera_takes_all():
    T = Pose.from_wxyz("cam", "target", [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.2])
    assert target_window(CUBE, T, CAMERA, WHOLE) == WHOLE


@pytest.mark.parametrize(
    "camera",
    [
        Camera(200, 100, 150.0, 150.0, 100.0, 50.0, (-0.3, 0.1, 0.0, 0.0, 0.0)),
        Camera(200, 100, 150.0, 150.0, 100.0, 50.0, (-0.02, 0.006, -0.004, 0.0008), "fisheye"),
    ],
)
def test_it_holds_bowed_edges_of_a_distorted_image(camera):
    T = Pose.from_wxyz("cam", "target", [1.0, 0.0, 0.0, 0.0], [0.5, -0.1, 3.5])
    edge = np.linspace(CUBE.min(axis=0), [0.5, -0.5, -0.5], 50)
    window = target_window(CUBE, T, camera, WHOLE)
    x, y = camera.project(T @ edge).T
    assert (x > window.x).all()
    assert (y > window.y).all()
    assert (x < window.x + window.width).all()
