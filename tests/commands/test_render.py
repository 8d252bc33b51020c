"""`proxnav render`: what the command line says about camera, sensor and surfaces is in the scenes."""

import json
from pathlib import Path

import pytest

from proxnav.cli.main import main
from proxnav.commands.render import RenderConfig, mission_of, scenes_of
from proxnav.geometry import Camera
from proxnav.geometry.camera_files import speed_json

OWN = Camera(width=200, height=160, fx=300.0, fy=300.0, cx=100.0, cy=80.0)


@pytest.fixture
def camera_file(tmp_path) -> Path:
    path = tmp_path / "camera.json"
    path.write_text(json.dumps(speed_json(OWN)))
    return path


@pytest.mark.parametrize("preset", ["observation-10-100m", "approach-100-10m"])
def test_camera_and_sensor_of_the_user_are_in_every_scene(preset, camera_file, tmp_path):
    config = RenderConfig(
        tmp_path / "set", mission=preset, frames=3, camera=camera_file, sensor="cmv4000-class-colour", particles=300.0
    )
    for scene in scenes_of(config, mission_of(config)):
        assert (scene.camera.width, scene.camera.fx) == (200, 300.0)
        assert scene.sensor.colour
        assert scene.sensor.bits == 10
        assert scene.sensor.particle_rate_cm2_s == 300.0


def test_strength_of_textures_is_within_what_was_asked_for(tmp_path):
    drawn = {kind: RenderConfig(tmp_path, frames=20, textures=kind) for kind in ("none", "mild", "full")}
    most = {
        kind: max(scene.texture.strength for scene in scenes_of(config, mission_of(config)))
        for kind, config in drawn.items()
    }
    assert most["none"] == 0.0
    assert 0.0 < most["mild"] <= 0.3 < most["full"] <= 1.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [(["--sensor", "imx999"], "no sensor 'imx999'"), (["--particles", "-3"], "--particles -3: give a rate")],
)
def test_what_no_camera_has_is_refused_before_anything_is_written(arguments, message, tmp_path, capsys):
    assert main(["render", "--out", str(tmp_path / "set"), "--frames", "1", *arguments]) == 1
    assert message in capsys.readouterr().err
    assert not (tmp_path / "set").exists()
