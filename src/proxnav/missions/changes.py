"""A mission with what a command line says otherwise."""

from dataclasses import replace

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.missions.mission import Mission
from proxnav.records.scene import TEXTURE_STRENGTHS, Textures
from proxnav.sensor.presets import sensor_by_name


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
