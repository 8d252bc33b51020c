"""A run folder, its description and reader.

poses.json    estimates               metrics.json   headline numbers; neither it nor truth.json where no truth is known
truth.json    true poses              overlays/      <best|median|worst>-NNNN.png, NNNN = place from best to worst
mission.toml  optional, the mission that it belongs to
config.json   optional, what was asked for and with which versions
frames.json   optional, what each frame was and what the detector saw in it
solution.csv  a navigation solution, alone or beside the rest
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from proxnav.datasets.formats.speed_poses import PoseRecord, read_poses
from proxnav.errors import InputError
from proxnav.evaluation import run_frames, solution_files
from proxnav.evaluation.pairing import PairedFrame, pair
from proxnav.evaluation.run_frames import FrameNote, read_run_frames
from proxnav.evaluation.solution_files import Solution, read_solution
from proxnav.storage.files import read_json

POSES, TRUTH, METRICS, CONFIG, OVERLAYS = "poses.json", "truth.json", "metrics.json", "config.json", "overlays"
MISSION = "mission.toml"
"""Name of the copy of its mission that a data set, run, flight or model carries."""
FRAMES, SOLUTION = run_frames.NAME, solution_files.NAME

_OVERLAY = re.compile(r"(best|median|worst)-(\d{1,9})\.png")


@dataclass(frozen=True, slots=True)
class Picture:
    """An overlay on disk and what it shows."""

    path: Path
    rank: str
    """best, median or worst."""
    place: int
    """Place of the frame from best (0) to worst."""


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """What a run folder holds."""

    frames: tuple[PairedFrame, ...]
    metrics: Mapping[str, Any]
    pictures: tuple[Picture, ...]
    """Overlays from worst to best."""
    config: Any = None
    notes: Mapping[str, FrameNote] = field(default_factory=dict)
    """What each frame was, by file name; empty where the run does not say."""
    solution: Solution | None = None
    """Navigation solution, if the run has one."""
    found: tuple[PoseRecord, ...] = ()
    """Poses of a run whose truth nobody knows, in place of `frames`."""


def read_run(folder: Path) -> Run:
    """The run in `folder`; InputError names what is missing or does not fit."""
    config = folder / CONFIG
    configuration = read_json(config, "the configuration of a run") if config.is_file() else None
    solution = read_solution(folder) if (folder / SOLUTION).is_file() else None
    if solution is not None and not (folder / POSES).is_file():
        return Run((), {}, (), configuration, solution=solution)
    if (folder / POSES).is_file() and not (folder / TRUTH).exists() and not (folder / METRICS).exists():
        found = tuple(read_poses(folder / POSES).values())
        return Run((), {}, _pictures_found(folder / OVERLAYS), configuration, solution=solution, found=found)
    metrics = read_json(folder / METRICS, "the headline numbers of a run")
    if not isinstance(metrics, dict):
        raise InputError(f"{folder / METRICS}: expected one object of numbers; run proxnav evaluate again")
    notes = read_run_frames(folder)
    return Run(
        frames=pair(read_poses(folder / POSES), read_poses(folder / TRUTH)),
        metrics=metrics,
        pictures=_pictures(folder / OVERLAYS),
        config=configuration,
        notes={} if notes is None else {note.filename: note for note in notes.frames},
        solution=solution,
    )


def overlay_files(folder: Path) -> list[Path]:
    """The overlays in a folder, by name; files of other names are none of ours."""
    return sorted(path for path in folder.glob("*.png") if _OVERLAY.fullmatch(path.name))


def telling(order: Sequence[int], each: int) -> list[tuple[str, int]]:
    """(file name, frame) of the overlays: up to `each` best, median and worst frames of an order from best to worst.

    Where there are too few for all, each kind has a third of them; no frame comes twice.
    """
    n = len(order)
    best, median, worst = (min(each, (n + extra) // 3) for extra in (2, 0, 1))
    middle = min(max((n - median) // 2, best), n - worst - median)
    places = {"best": (0, best), "median": (middle, median), "worst": (n - worst, worst)}
    return [
        (f"{kind}-{place:04d}.png", order[place])
        for kind, (start, count) in places.items()
        for place in range(start, start + count)
    ]


def _pictures_found(folder: Path) -> tuple[Picture, ...]:
    """Overlays of a run without truth, by name."""
    return tuple(Picture(path, "found", place) for place, path in enumerate(sorted(folder.glob("*.png"))))


def _pictures(folder: Path) -> tuple[Picture, ...]:
    """Overlays from worst to best."""
    named = [(path, _OVERLAY.fullmatch(path.name)) for path in overlay_files(folder)]
    found = [Picture(path, match[1], int(match[2])) for path, match in named if match]
    return tuple(sorted(found, key=lambda picture: -picture.place))
