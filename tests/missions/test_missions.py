"""Missions: shipped ones, their TOML, and what is derived from them."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from proxnav.errors import InputError, InputNote
from proxnav.geometry import Camera
from proxnav.geometry.calibration import CalibrationSigma
from proxnav.missions import Mission, fly_mission, load_mission, write_mission
from proxnav.missions.files import mission_toml, parse_mission, shipped_missions
from proxnav.missions.flights import FLIGHTS
from proxnav.sensor.presets import SPEED_CLASS

OBSERVATION = load_mission("observation-10-100m")


@pytest.mark.parametrize("name", shipped_missions())
def test_a_shipped_mission_is_called_as_its_file_and_flies_what_exists(name: str) -> None:
    mission = load_mission(name)
    assert mission.name == name
    assert mission.flight.trajectory in ("", *FLIGHTS)


@pytest.mark.parametrize("name", shipped_missions())
def test_a_mission_written_as_toml_reads_back_equal(name: str, tmp_path: Path) -> None:
    mission = replace(
        load_mission(name), sensor=replace(SPEED_CLASS, read_noise_e=9.5, quantum_efficiency=(0.1, 0.2, 0.3))
    )
    write_mission(tmp_path / "own.toml", mission)
    assert load_mission(tmp_path / "own.toml") == mission


def test_a_sensor_of_no_name_is_written_in_full(tmp_path: Path) -> None:
    mission = replace(OBSERVATION, sensor=replace(SPEED_CLASS, name="my-camera", bits=12))
    write_mission(tmp_path / "own.toml", mission)
    assert load_mission(tmp_path / "own.toml").sensor == mission.sensor


def test_degrees_become_radians_and_words_become_limits() -> None:
    scenes = OBSERVATION.scenes
    assert scenes.view.roll_limit_rad == np.radians(30.0)
    assert (scenes.sun.min_phase_rad, scenes.sun.max_phase_rad) == (0.0, np.radians(90.0))
    free = replace(OBSERVATION, view=replace(OBSERVATION.view, roll_deg="any", attitude="any")).scenes
    assert (free.view.roll_limit_rad, free.tumbling_share) == (np.pi, 1.0)
    assert not replace(OBSERVATION, looks=replace(OBSERVATION.looks, earth="none")).scenes.earth


def test_training_is_wider_than_the_mission_and_alike_in_the_rest() -> None:
    wider = OBSERVATION.training_mission
    assert wider.light.phase_deg == (0.0, 110.0)
    assert wider.looks.textures == (0.0, 1.0)
    assert replace(wider, light=OBSERVATION.light, looks=OBSERVATION.looks) == OBSERVATION


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("name = 3", "name must be text, found 3"),
        ("[view]\nrange = [1.0, 2.0]", "view: unknown key 'range'; did you mean range_m"),
        ("[view]\nrange_m = [1.0]", "view: range_m must be an array of 2 numbers, found"),
        ("[view]\nroll_deg = 'some'", "roll_deg must be a number or 'any', found 'some'"),
        ("[view]\nrange_m = [5.0, 1.0]", "range_m needs 0 < least <= most"),
        ("[light]\nphase_deg = [90.0, 10.0]", "light.phase_deg needs 0 <= least <= most"),
        ("[training]\nphase_deg = true", "training: phase_deg must be"),
        ("[camera]\nwidth = 10", "height, fx, fy, cx, cy missing"),
        ("camera = 3", "no table .camera."),
        ("frames = 0", "frames must be at least 1"),
        ("[camera]\nsensor = 'eye'", "no sensor 'eye'"),
    ],
)
def test_a_mission_with_a_fault_is_refused_in_a_sentence(change: str, said: str) -> None:
    content = tomllib.loads(mission_toml(OBSERVATION))
    for key, value in tomllib.loads(change).items():
        whole = (isinstance(value, dict) and key != "camera") or "sensor" in str(value)
        content[key] = content[key] | value if whole else value
    with pytest.raises(InputError, match=said):
        parse_mission(content, "own.toml").scenes  # noqa: B018


def test_a_name_that_is_no_mission_lists_those_that_are(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no mission 'observation'; one of .*observation-10-100m.*or a TOML file"):
        load_mission("observation")
    (tmp_path / "broken.toml").write_text("name =")
    with pytest.raises(InputError, match=r"broken.toml: not readable as TOML"):
        load_mission(tmp_path / "broken.toml")


def test_the_mission_of_the_documentation_is_one_and_the_table_there_lists_those_that_are_shipped() -> None:
    page = (Path(__file__).parents[2] / "docs" / "missions.md").read_text()
    content = tomllib.loads(page.split("```toml\n")[1].split("```")[0])
    assert parse_mission(content, "missions.md").view.attitude == "any"
    rows = page.split("## Shipped")[1].splitlines()
    assert {row.split("`")[1] for row in rows if row.startswith("| `")} == set(shipped_missions())


FLOWN = """
[flight]
files = ["ok.oem", "hill/lvlh_vbar.csv"]
[flight.reader]
epoch_utc = "2026-01-01T00:00:00Z"
step_s = 30
[flight.reader.target_orbit]
altitude_m = 500e3
"""


def flown_mission(folder: Path) -> Path:
    """A mission file beside a target's orbit and the chaser's path in LVLH."""
    data = Path(__file__).parents[1] / "data" / "trajectories"
    (folder / "hill").mkdir()
    (folder / "ok.oem").write_text((data / "ok.oem").read_text())
    (folder / "hill" / "lvlh_vbar.csv").write_text((data / "lvlh_vbar.csv").read_text())
    path = folder / "mine.toml"
    path.write_text(mission_toml(OBSERVATION) + FLOWN)
    return path


def test_a_mission_flies_the_files_beside_it_as_its_reader_says(tmp_path: Path) -> None:
    mission = load_mission(flown_mission(tmp_path))
    assert mission.flight.reader.target_orbit.altitude_m == 500e3
    with pytest.warns(InputNote, match=r"hill/lvlh_vbar\.csv: read as LVLH .* whose orbit is that of .*ok\.oem"):
        flight = fly_mission(mission)
    assert flight.t == pytest.approx(np.arange(0.0, 601.0, 30.0))
    assert flight.range_m[0] == pytest.approx(np.sqrt(200.0))


def test_a_mission_that_is_written_elsewhere_still_finds_its_files(tmp_path: Path) -> None:
    mission = load_mission(flown_mission(tmp_path))
    (tmp_path / "set").mkdir()
    write_mission(tmp_path / "set" / "mission.toml", mission)
    assert load_mission(tmp_path / "set" / "mission.toml") == mission
    assert "q_chaser_cam" not in mission_toml(mission)  # what is usual is not written
    assert hash(mission) == hash(load_mission(tmp_path / "mine.toml"))


@pytest.mark.parametrize(
    ("flight", "said"),
    [
        (
            'trajectory = "hold-30m"\nfiles = ["a.oem"]',
            "either generated or read, found trajectory 'hold-30m' and files",
        ),
        ('files = "a.oem"', "flight: files must be .*, found 'a.oem'"),
        ('files = ["a.oem"]\nreader = {fram = "RIC"}', "flight: reader: unknown key 'fram'; did you mean frame"),
        (
            'files = ["a.oem"]\nreader = {target_orbit = {altitude_m = "low"}}',
            "target_orbit: altitude_m must be a number",
        ),
        ('files = ["a.oem"]\nreader = 3', "flight: reader must be a table"),
        ('reader = {frame = "RIC"}', r"\[flight.reader\] says how files are read, and there are none"),
    ],
)
def test_a_flight_with_a_fault_is_refused_in_a_sentence(flight: str, said: str) -> None:
    content = tomllib.loads(mission_toml(OBSERVATION) + "\n[flight]\n" + flight)
    with pytest.raises(InputError, match=said):
        parse_mission(content, "own.toml")


def test_a_mission_whose_files_are_gone_says_so(tmp_path: Path) -> None:
    path = flown_mission(tmp_path)
    (tmp_path / "ok.oem").unlink()
    with pytest.raises(InputError, match=r"ok\.oem: no such file"):
        fly_mission(load_mission(path))


def test_a_mission_is_a_value() -> None:
    assert isinstance(OBSERVATION, Mission)
    assert hash(OBSERVATION) == hash(load_mission("observation-10-100m"))


def test_a_mission_takes_its_camera_from_a_calibration_file_beside_it(tmp_path: Path) -> None:
    (tmp_path / "info.yaml").write_text(
        "width: 640\nheight: 480\nk: [600.0, 0, 319.5, 0, 601.0, 239.5, 0, 0, 1]\nd: [-0.02, 0.006, -0.004, 0.0008]\n"
        "distortion_model: equidistant\n"
    )
    sigma = "calibration_sigma = {focal = 0.001, principal_px = 0.5}"
    (tmp_path / "own.toml").write_text(f'name = "own"\n[camera]\nfile = "info.yaml"\nsensor = "speed-class"\n{sigma}\n')
    with pytest.warns(InputNote, match="principal point converted from pixel centres"):
        mission = load_mission(tmp_path / "own.toml")
    expected = Camera(640, 480, 600.0, 601.0, 320.0, 240.0, (-0.02, 0.006, -0.004, 0.0008), "fisheye")
    assert mission.camera == replace(expected, calibration_sigma=CalibrationSigma(0.001, 0.5))
    write_mission(tmp_path / "again.toml", mission)
    assert load_mission(tmp_path / "again.toml") == mission


def test_a_camera_file_stands_alone(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text('name = "own"\n[camera]\nfile = "info.yaml"\nfx = 600.0\n')
    with pytest.raises(InputError, match="names a calibration file and stands alone, found also fx"):
        load_mission(tmp_path / "own.toml")


def test_a_camera_as_usual_is_written_as_it_always_was() -> None:
    assert set(tomllib.loads(mission_toml(OBSERVATION))["camera"]) <= {
        "width", "height", "fx", "fy", "cx", "cy", "distortion", "sensor",
    }  # fmt: skip


def test_a_roll_beyond_half_a_turn_is_refused() -> None:
    mission = load_mission("observation-10-100m")
    with pytest.raises(InputError, match="roll_deg needs 0 to 180"):
        replace(mission, view=replace(mission.view, roll_deg=400.0))


def test_an_unknown_key_is_answered_with_all_known_ones() -> None:
    content = tomllib.loads(mission_toml(load_mission("observation-10-100m")))
    with pytest.raises(InputError, match=r"unknown key 'port'; name, target, frames.*view"):
        parse_mission(content | {"port": "nose"}, "tour")
