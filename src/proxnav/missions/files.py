"""Missions as TOML: read strictly, written completely, shipped by name."""

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import tomlkit

from proxnav.errors import InputError, did_you_mean
from proxnav.evaluation.run_folder import MISSION
from proxnav.missions.cameras import camera_table, mission_camera
from proxnav.missions.mission import Flight, Lighting, Looks, Mission, TrainingRanges, ViewRanges
from proxnav.missions.table import from_table, to_table
from proxnav.records import SensorSpec
from proxnav.sensor.presets import SENSORS, sensor_by_name
from proxnav.storage.files import write_atomic
from proxnav.trajectories.readers.config import ReaderConfig

SHIPPED = Path(__file__).parent / "shipped"
_MOST_BYTES = 2**20
_SECTIONS = {"view": ViewRanges, "light": Lighting, "looks": Looks, "flight": Flight, "training": TrainingRanges}
_SENSOR_KEY = "sensor"
"""In [camera]: name of a sensor; the table [sensor] says in what the mission's own differs from it."""


def shipped_missions() -> tuple[str, ...]:
    """Names of the missions that come with the package."""
    return tuple(sorted(path.stem for path in SHIPPED.glob("*.toml")))


def load_mission(name_or_path: str | Path) -> Mission:
    """A shipped mission by name, or a TOML file.

    >>> load_mission("observation-10-100m").view.range_m
    (10.0, 100.0)
    """
    path = Path(name_or_path)
    if str(name_or_path) in shipped_missions():
        path = SHIPPED / f"{name_or_path}.toml"
    elif not path.is_file():
        near = did_you_mean(str(name_or_path), shipped_missions())
        raise InputError(f"no mission '{name_or_path}'; one of {', '.join(shipped_missions())}, or a TOML file{near}")
    return parse_mission(_content(path), str(path))


def mission_in(folder: Path) -> Mission | None:
    """The mission that a data set, run, flight or model carries; None where it carries none."""
    path = folder / MISSION
    return load_mission(path) if path.is_file() else None


def parse_mission(content: dict[str, Any], where: str) -> Mission:
    """A mission from the tables of its TOML; InputError names the key at fault in `where`."""
    plain = dict(content)
    camera = plain.pop("camera", None)
    if not isinstance(camera, dict):
        raise InputError(
            f"{where}: no table [camera]; a mission needs width, height, fx, fy, cx, cy or a file, and a sensor"
        )
    sections = {key: from_table(kind, plain.pop(key, {}), f"{where}: {key}") for key, kind in _SECTIONS.items()}
    camera = dict(camera)
    base = sensor_by_name(str(camera.pop(_SENSOR_KEY, "ideal")))
    own = from_table(SensorSpec, plain.pop("sensor", {}), f"{where}: sensor", base)
    sections["flight"] = _from_folder(sections["flight"], Path(where).parent)
    fields = {"camera": mission_camera(camera, f"{where}: camera", Path(where).parent), "sensor": own} | sections
    return from_table(Mission, plain, where, known=fields)


def mission_toml(mission: Mission) -> str:
    """A mission as TOML that reads back equal."""
    table = to_table(mission)
    sensor = SENSORS.get(mission.sensor.name, SensorSpec())
    table["camera"] = camera_table(mission.camera) | {_SENSOR_KEY: sensor.name}
    table["sensor"] = to_table(mission.sensor, than=sensor)
    table["flight"] = to_table(mission.flight, than=Flight())
    if "reader" in table["flight"]:
        table["flight"]["reader"] = to_table(mission.flight.reader, than=ReaderConfig())
    return tomlkit.dumps({key: value for key, value in table.items() if value != {}})


def write_mission(path: Path, mission: Mission) -> None:
    """Writes the mission's TOML, whole or not at all."""
    write_atomic(path, mission_toml(mission).encode())


def _from_folder(flight: Flight, folder: Path) -> Flight:
    """The flight with its files found from a folder on, wherever the mission is written to afterwards."""
    return replace(flight, files=tuple(str((folder / name).resolve()) for name in flight.files))


def _content(path: Path) -> dict[str, Any]:
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise InputError(f"{path}: larger than {_MOST_BYTES // 2**20} MiB, which no mission is")
        return tomllib.loads(path.read_text("utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: not readable as TOML ({error})") from None
