"""A scene as a line of JSON, and back."""

import json
from dataclasses import replace

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.records import EarthSpec, SceneSpec, SunSpec

CAMERA = Camera(64, 48, 60.0, 61.0, 32.0, 24.0, (-0.1, 0.02, 0.0, 0.001, 0.0))


def scene(index=0, z=10.0):
    return SceneSpec(
        index, "boxcraft", CAMERA, (0.9, 0.1, -0.3, np.sqrt(0.09)), (0.1, 0.2, z), SunSpec((0.6, 0.0, 0.8)),
        EarthSpec((0.0, 0.0, 6.778e6), (1.0, 0.0, 0.0, 0.0)),
    )  # fmt: skip


def test_a_scene_line_reads_back_equal():
    line = json.dumps(scene().to_json())
    assert SceneSpec.from_json(json.loads(line)) == scene()


def test_fields_that_came_later_are_written_only_where_they_say_something():
    plain, earth = scene(), replace(scene().earth, cloud_image="/data/cloud.png")
    full = replace(plain, earth=earth, sensor=replace(plain.sensor, dead_pixel_share=1e-5))
    full = replace(full, sun=replace(plain.sun, half_angle_rad=0.1))
    assert "half_angle_rad" not in plain.to_json()["sun"]
    assert "cloud_image" not in plain.to_json()["earth"]
    assert "dead_pixel_share" not in plain.to_json()["sensor"]
    assert "earth" in replace(plain, earth=None).to_json()
    assert SceneSpec.from_json(json.loads(json.dumps(full.to_json()))) == full


@pytest.mark.parametrize(
    ("change", "sentence"),
    [({"version": 9}, "version"), ({"sun": 3}, "scene.sun"), ({"nonsense": 1}, "nonsense")],
)
def test_a_wrong_scene_line_is_refused_by_name(change, sentence):
    with pytest.raises(InputError, match=sentence):
        SceneSpec.from_json(json.loads(json.dumps(scene().to_json())) | change)


def test_a_scene_differs_when_its_range_does():
    assert replace(scene(), t_cam_target_m=(0.0, 0.0, 9.0)) != scene()
