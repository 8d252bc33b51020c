"""The chain as prose: fly, draw scenes, render frames, estimate poses, judge them, report; each stage is one call."""

from pathlib import Path
from typing import Any

from proxnav.cluster.progress import Progress, silent
from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.evaluation.judgement import Judgement, judge
from proxnav.frames import FrameConfig
from proxnav.missions import Mission, fly
from proxnav.missions.scenes import follow
from proxnav.rendered_set import render
from proxnav.viewing.run_writer import write_report, write_run


def run(
    mission: Mission, frames: int, seed: int, rendering: FrameConfig, model: str, out: Path, options: Any,
    progress: Progress = silent,
) -> Judgement:  # fmt: skip
    """Flies a mission's trajectory, renders `frames` of it, estimates every pose; the run folder `out` holds the rest.

    `options` is the dataclass that the run was asked with, which config.json keeps. The same call resumes.
    """
    estimator = PoseEstimator.load(model)
    if not mission.flight.trajectory:
        raise InputError(f"mission '{mission.name}' has no trajectory to fly; spiral-10-100m, for one, has")
    trajectory = fly(mission.flight.trajectory)

    scenes = follow(trajectory, mission, frames, seed)

    with progress(f"render ({rendering.renderer})", len(scenes)) as done:
        dataset = render(scenes, rendering, out / f"images-{rendering.renderer}", 1, done)

    records, keypoints = [], []
    with progress("estimate", len(dataset)) as done:
        for k, label in enumerate(dataset.labels):
            found, result = estimator.observe(dataset.image(k), dataset.camera)
            records.append(PoseRecord(label.filename, result.T_cam_target, result.status, result.covariance))
            keypoints.append(found)
            done()

    judgement = judge(records, dataset)

    write_run(out, judgement, dataset, estimator.points_target_m, keypoints, options)
    write_report(out, f"demo: {mission.name}")
    return judgement
