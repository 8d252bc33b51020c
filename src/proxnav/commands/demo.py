"""`proxnav demo`: the whole chain, small: fly a stretch of the spiral, render it, estimate, compare, report."""

from dataclasses import dataclass
from pathlib import Path

from proxnav.cli.progress import progress, say_when_compiling
from proxnav.commands.estimate import find_images, observe_images
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.frames import FrameConfig, Renderer
from proxnav.missions import fly, load_mission
from proxnav.pipeline import follow, judge, render, write_run
from proxnav.storage.files import write_atomic
from proxnav.viewing.report import report_html


@dataclass(frozen=True)
class DemoConfig:
    """Renders a stretch of the spiral with shipped weights in the loop and writes a report one can look at."""

    out: Path = Path("out/demo")
    """Folder of the run."""
    preset: str = "spiral-10-100m"
    """A mission with a trajectory."""
    frames: int = 12
    renderer: Renderer = "cycles"
    """cycles (Blender) or raycast."""
    samples: int = 16
    """Cycles: samples per pixel."""
    model: str = "space-rider"
    """Name of a shipped model, or a folder with a model.json."""
    seed: int = 0


def run(config: DemoConfig) -> None:
    """Fly, render, estimate, judge, write."""
    mission = load_mission(config.preset)
    if not mission.flight.trajectory:
        raise InputError(f"mission '{config.preset}' has no trajectory to fly; spiral-10-100m, for one, has")
    estimator = PoseEstimator.load(config.model)
    scenes = follow(fly(mission.flight.trajectory), mission, config.frames, config.seed)
    say_when_compiling("rendering")
    with progress(f"render ({config.renderer})", len(scenes)) as done:
        images = config.out / f"images-{config.renderer}"
        dataset = render(scenes, FrameConfig(config.renderer, config.samples), images, 1, done)
    records, keypoints = observe_images(estimator, find_images(images), dataset.camera)
    judgement = judge(records, dataset)
    write_run(config.out, judgement, dataset, estimator, config, keypoints=keypoints)
    write_atomic(config.out / "report.html", report_html(config.out, f"demo: {config.preset}").encode())
    print(judgement.text())
    print(f"\nlook at {config.out / 'report.html'} and {config.out / 'overlays'}")
