"""The chain as prose: fly, draw scenes, render frames, estimate poses, judge them, report; each stage is one call."""

from pathlib import Path
from typing import Any

from proxnav.cluster.progress import Progress, silent
from proxnav.estimation import estimate_images
from proxnav.evaluation.judgement import Judgement, judge
from proxnav.frames import FrameConfig
from proxnav.missions import MISSION, Mission, fly_mission, write_mission
from proxnav.missions.scenes import follow
from proxnav.models.loading import load_card
from proxnav.rendered_set import render
from proxnav.viewing.run_writer import write_report, write_run


def run(
    mission: Mission, frames: int, seed: int, rendering: FrameConfig, model: str, out: Path, options: Any,
    progress: Progress = silent,
) -> Judgement:  # fmt: skip
    """Flies a mission's trajectory, renders `frames` of it, estimates every pose; the run folder `out` holds the rest.

    `options` is the dataclass that the run was asked with, which config.json keeps. The same call resumes.
    """
    points_m = load_card(model).keypoints_m

    trajectory = fly_mission(mission)

    scenes = follow(trajectory, mission, frames, seed)

    with progress(f"render ({rendering.renderer})", len(scenes)) as done:
        dataset = render(scenes, rendering, out / f"images-{rendering.renderer}", 1, done)

    with progress("estimate", len(dataset)) as done:
        records, keypoints = estimate_images(dataset.image_paths, dataset.camera, model, done=done)

    judgement = judge(records, dataset)

    write_mission(out / MISSION, mission)
    write_run(out, judgement, dataset, points_m, keypoints, options)
    write_report(out, f"demo: {mission.name}")
    return judgement
