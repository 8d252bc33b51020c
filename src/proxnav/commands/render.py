"""`proxnav render`: a data set or a sequence, from a mission or a trajectory file."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from proxnav.cli.options import CameraOptions, DryRunOptions, MissionOptions, TrajectoryOptions, WorkerOptions
from proxnav.missions import Mission
from proxnav.records.scene import SceneSpec, Textures
from proxnav.rendering.config import FrameConfig, Renderer


@dataclass(frozen=True)
class RenderConfig(MissionOptions, TrajectoryOptions, CameraOptions, WorkerOptions, DryRunOptions):
    """Renders labelled images into a data set folder; the same command resumes. What is not given is the mission's."""

    out: Path
    """Folder of the data set."""
    sensor: str | None = None
    """Name of the image sensor, such as speed-class, cmv4000-class or speedplus-class: docs/sensor.md"""
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
    """Renders the frames, or says what it would take."""
    from proxnav.benchmarks.dry_run import rendering_dry_run
    from proxnav.cli.progress import progress, say_when_compiling
    from proxnav.missions import MISSION, write_mission
    from proxnav.missions.daylight import eclipse_line
    from proxnav.rendered_set import render

    say_when_compiling("rendering")
    mission = mission_of(config)
    scenes, rendering = scenes_of(config, mission), FrameConfig(config.renderer, config.samples)
    if config.dry_run:
        print(rendering_dry_run(scenes, rendering, config.workers))
        return
    with progress("render", len(scenes)) as done:
        dataset = render(scenes, rendering, config.out, config.workers, done, config.on)
    write_mission(config.out / MISSION, mission)
    print(", ".join(filter(None, [f"{len(dataset)} frames in {config.out}", eclipse_line(scenes)])))


def mission_of(config: RenderConfig) -> Mission:
    """The mission with what the command line says otherwise."""
    from proxnav.missions.changes import along, changed

    mission = along(config.read_mission(), config.trajectory, config.reader)
    camera = config.camera_or(lambda: mission.camera)
    return changed(mission, camera, config.sensor, config.particles, config.textures)


def scenes_of(config: RenderConfig, mission: Mission) -> list[SceneSpec]:
    """The scenes that a configuration asks for, of its mission."""
    from proxnav.missions.scenes import mission_scenes, under_clouds

    return under_clouds(mission_scenes(mission, config.frames, config.seed, config.size), config.clouds)
