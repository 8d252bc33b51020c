"""The live view: it serves, and takes images with and without a pose."""

import socket

import numpy as np
import pytest

from boxcraft import boxcraft
from proxnav.geometry import Camera, Pose
from proxnav.viewing.live_view import LiveView
from proxnav.viewing.outline_overlay import outline_overlay

CAMERA = Camera(64, 48, 80.0, 80.0, 32.0, 24.0)
POSE = Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [0, 0, 9])
IMAGE = np.zeros((48, 64), np.uint8)


def test_a_view_is_served_where_its_address_says():
    pytest.importorskip("rerun", reason="needs the extra view")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    view = LiveView(CAMERA, boxcraft(), port)
    view.show(0.0, IMAGE, "1.png: ok", POSE, None)
    view.show(1.0, IMAGE, "2.png: lost", None, None)
    assert str(port) in view.url
    with socket.create_connection(("127.0.0.1", port), timeout=10.0):
        pass
    view.close()


def test_the_outline_is_drawn_where_the_box_is_and_nowhere_else():
    drawn = outline_overlay(IMAGE, CAMERA, boxcraft(), POSE).any(axis=2)
    rows, columns = np.nonzero(drawn)
    corners = CAMERA.project(POSE @ boxcraft().vertices_m)
    assert drawn.sum() > 50
    low, high = corners.min(axis=0) - 1.0, corners.max(axis=0) + 1.0  # px
    assert low[0] <= columns.min() <= columns.max() <= high[0]
    assert low[1] <= rows.min() <= rows.max() <= high[1]


def test_a_pose_outside_of_the_image_draws_nothing():
    aside = Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [50, 0, 9])
    assert not outline_overlay(IMAGE, CAMERA, boxcraft(), aside).any()
