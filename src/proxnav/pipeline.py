"""The chain as prose: fly, render frames, estimate and judge poses, fuse them, report; each stage is one call."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from proxnav.cluster.progress import Progress, silent
from proxnav.estimation import estimate_images
from proxnav.evaluation.judgement import Judgement, judge
from proxnav.frames import FrameConfig
from proxnav.geometry.calibration import EXACT
from proxnav.missions import MISSION, Mission, write_mission
from proxnav.models.loading import load_card
from proxnav.navigation.config import NavigationConfig
from proxnav.photographed_flight import PhotographedFlight
from proxnav.rendered_set import render
from proxnav.solutions import FlightSolution, SolutionOptions, solve_flight
from proxnav.viewing.run_writer import write_report, write_run


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What the chain ended with."""

    judgement: Judgement
    """Single poses beside their truth."""
    solution: FlightSolution | None
    """What the filter made of them; None where there was no pose."""


def run(
    mission: Mission, frames: int, seed: int, rendering: FrameConfig, model: str, out: Path, options: Any,
    progress: Progress = silent,
) -> Outcome:  # fmt: skip
    """Flies a lit stretch of a mission, renders `frames` of it, estimates every pose and fuses them with the other
    sensors; the run folder `out` holds the rest.

    `options` is the dataclass that the run was asked with, which config.json keeps. The same call resumes.
    """
    points_m = load_card(model).keypoints_m

    flight = PhotographedFlight.of(mission, frames, seed)

    with progress(f"render ({rendering.renderer})", len(flight.scenes)) as done:
        dataset = render(flight.scenes, rendering, out / f"images-{rendering.renderer}", 1, done)

    with progress("estimate", len(dataset)) as done:
        records, keypoints = estimate_images(dataset.image_paths, dataset.camera, model, done=done)

    judgement = judge(records, dataset)

    is_seen = flight.write_records(out / "records", records) > 0
    how = SolutionOptions(points_m, None, EXACT, None, 1.0, False, NavigationConfig())
    solution = solve_flight(out / "records", how, out, progress) if is_seen else None

    write_mission(out / MISSION, mission)
    write_run(out, judgement, dataset, points_m, keypoints, options)
    write_report(out, f"demo: {mission.name}")
    return Outcome(judgement, solution)
