"""A mission with what a command line says otherwise."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.missions.mission import Flight, Mission
from proxnav.records.scene import TEXTURE_STRENGTHS, Textures
from proxnav.sensor.presets import sensor_by_name
from proxnav.trajectories.readers.config import ReaderConfig


def along(mission: Mission, files: Sequence[Path], reader: ReaderConfig) -> Mission:
    """The mission with the flight that files hold; unchanged without files."""
    if not files and reader != ReaderConfig():
        raise InputError("--reader says how trajectory files are read; give them with --trajectory")
    if not files:
        return mission
    return replace(mission, flight=Flight(files=tuple(str(Path(f).resolve()) for f in files), reader=reader))


def changed(
    mission: Mission, camera: Camera | None = None, sensor: str | None = None, particles_cm2_s: float | None = None,
    textures: Textures | None = None,
) -> Mission:  # fmt: skip
    """The mission with another camera, sensor by name, rate of particles or strength of textures."""
    if camera is not None:
        mission = replace(mission, camera=camera)
    if sensor is not None:
        mission = replace(mission, sensor=sensor_by_name(sensor))
    if particles_cm2_s is not None:
        if not 0.0 <= particles_cm2_s < 1e6:
            raise InputError(
                f"--particles {particles_cm2_s:g}: give a rate per cm2 and s of 0 or more, below a million"
            )
        mission = replace(mission, sensor=replace(mission.sensor, particle_rate_cm2_s=particles_cm2_s))
    if textures is not None:
        mission = replace(mission, looks=replace(mission.looks, textures=TEXTURE_STRENGTHS[textures]))
    return mission
