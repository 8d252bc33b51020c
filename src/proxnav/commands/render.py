"""`proxnav render`: a data set or a sequence, from a mission or a trajectory file."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Literal

import tyro

from proxnav.benchmarks.dry_run import rendering_dry_run
from proxnav.cli.options import DryRunOptions, WorkerOptions
from proxnav.cli.progress import progress, say_when_compiling
from proxnav.errors import InputError
from proxnav.frames import FrameConfig, Renderer
from proxnav.geometry import Camera
from proxnav.missions import Mission, fly, load_mission
from proxnav.missions.scenes import draw_scenes, follow
from proxnav.records import SceneSpec
from proxnav.rendered_set import render
from proxnav.sensor.presets import sensor_by_name
from proxnav.trajectories.read import read_trajectory
from proxnav.trajectories.readers.config import ReaderConfig

Textures = Literal["none", "mild", "full"]
STRENGTHS: dict[Textures, tuple[float, float]] = {"none": (0.0, 0.0), "mild": (0.0, 0.3), "full": (0.0, 1.0)}
"""Limits of the strength of frames drawn one by one."""


@dataclass(frozen=True)
class RenderConfig(WorkerOptions, DryRunOptions):
    """Renders labelled images into a data set folder; the same command resumes. What is None is the mission's."""

    out: Path
    """Folder of the data set."""
    preset: str = "observation-10-100m"
    """observation-10-100m, study, spiral-10-100m, approach-100-10m or sroc-200-350m."""
    trajectory: tuple[Path, ...] = ()
    """Trajectory file(s) in place of the mission's: docs/trajectories.md"""
    reader: ReaderConfig = field(default_factory=ReaderConfig)
    """What the trajectory files do not say themselves."""
    target: str | None = None
    """Name or file of the target."""
    camera: Path | None = None
    """camera.json of your own camera."""
    sensor: str | None = None
    """speed-class or cmv4000-class, either also with -colour."""
    particles: Annotated[float | None, tyro.conf.arg(metavar="N")] = None
    """Particles per cm2 and s: 3 in quiet, 100 to 1000 in the South Atlantic."""
    textures: Textures | None = None
    """How far the surfaces of random scenes depart from nominal."""
    renderer: Renderer = "cycles"
    """cycles (Blender) or raycast."""
    frames: int | None = None
    """Number of frames."""
    seed: int = 0
    """Same seed, same data set."""
    size: int | None = None
    """Longer side of the image [px]."""
    samples: Annotated[int, tyro.conf.arg(metavar="N")] = 32
    """Cycles: samples per pixel."""
    clouds: Path | None = None
    """Equirectangular picture of cloud, white where opaque."""


def run(config: RenderConfig) -> None:
    """Entry of `proxnav render`."""
    if config.samples < 1 or (config.frames is not None and config.frames < 1):
        raise InputError("--samples and --frames must be at least 1")
    say_when_compiling("rendering")
    scenes = scenes_of(config)
    if config.clouds is not None:
        scenes = under_clouds(scenes, config.clouds)
    if config.dry_run:
        print(rendering_dry_run(scenes, FrameConfig(config.renderer, config.samples), config.workers))
        return
    with progress("render", len(scenes)) as done:
        dataset = render(
            scenes, FrameConfig(config.renderer, config.samples), config.out, config.workers, done, config.on
        )
    print(f"{len(dataset)} frames in {config.out}")


def under_clouds(scenes: list[SceneSpec], picture: Path) -> list[SceneSpec]:
    """The scenes with a picture's cloud over their Earth."""
    if not picture.is_file():
        raise InputError(f"{picture}: no such file; --clouds names an equirectangular picture of cloud")
    image = str(picture.resolve())
    return [
        scene if scene.earth is None else replace(scene, earth=replace(scene.earth, cloud_image=image))
        for scene in scenes
    ]


def scenes_of(config: RenderConfig) -> list[SceneSpec]:
    """The scenes that a configuration asks for."""
    mission = _chosen(config)
    frames = config.frames or mission.frames
    if config.trajectory:
        return follow(read_trajectory(config.trajectory, config.reader), mission, frames, config.seed, config.size)
    if mission.flight.trajectory:
        return follow(fly(mission.flight.trajectory), mission, frames, config.seed, config.size)
    return draw_scenes(mission, frames, config.seed, config.size)


def _chosen(config: RenderConfig) -> Mission:
    """The mission with what the command line says otherwise."""
    mission = load_mission(config.preset)
    camera = mission.camera if config.camera is None else Camera.from_speed_json(config.camera)
    sensor = mission.sensor if config.sensor is None else sensor_by_name(config.sensor)
    if config.particles is not None:
        if not 0.0 <= config.particles < 1e6:
            raise InputError(
                f"--particles {config.particles:g}: give a rate per cm2 and s of 0 or more, below a million"
            )
        sensor = replace(sensor, particle_rate_cm2_s=config.particles)
    textures = mission.looks.textures if config.textures is None else STRENGTHS[config.textures]
    looks = replace(mission.looks, textures=textures)
    return replace(mission, target=config.target or mission.target, camera=camera, sensor=sensor, looks=looks)
