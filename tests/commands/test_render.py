"""`proxnav render`: what the command line says about camera, sensor and surfaces is in the scenes."""

import json
from pathlib import Path

import numpy as np
import pytest

from proxnav.cli.main import main
from proxnav.commands.render import RenderConfig, mission_of, scenes_of
from proxnav.errors import InputNote
from proxnav.geometry import Camera
from proxnav.geometry.camera_files import speed_json
from proxnav.trajectories import OrbitConfig, ReaderConfig

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


HILL = Path(__file__).parents[1] / "data" / "trajectories" / "lvlh_vbar.csv"


def test_files_of_the_command_line_are_the_flight_of_the_mission_that_the_set_carries(tmp_path):
    reader = ReaderConfig(target_orbit=OrbitConfig(argument_of_latitude_deg=250.0), stop_s=600.0)
    config = RenderConfig(tmp_path / "set", frames=3, trajectory=(HILL,), reader=reader)
    mission = mission_of(config)
    assert mission.flight.files == (str(HILL),)
    with pytest.warns(InputNote, match="14.14 to 20.93 m from the target"):
        scenes = scenes_of(config, mission)
    ranges = [float(np.linalg.norm(scene.t_cam_target_m)) for scene in scenes]
    assert ranges == pytest.approx([14.142, 15.915, 20.93], abs=0.01)


def test_a_flight_in_the_dark_is_refused_before_anything_is_written(tmp_path, capsys):
    dark = ["--trajectory", str(HILL), "--reader.stop-s", "600"]  # ten minutes from the node, in Earth's shadow
    assert main(["render", "--out", str(tmp_path / "set"), "--frames", "2", *dark]) == 1
    lines = [line for line in capsys.readouterr().err.splitlines() if "first use" not in line]
    assert lines[0].startswith(f"proxnav render: note: {HILL}: read as LVLH (x ahead, V-bar;")
    assert "the target is in eclipse at all 11 instants" in lines[1]
    assert len(lines) == 2
    assert not (tmp_path / "set").exists()


def test_options_of_a_reader_without_files_are_refused(tmp_path, capsys):
    assert main(["render", "--out", str(tmp_path / "set"), "--reader.frame", "RIC"]) == 1
    assert "--reader says how trajectory files are read; give them with --trajectory" in capsys.readouterr().err
