"""Trials drawn and estimated over processes or machines, each answer kept on disk: an interrupted run goes on."""

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from proxnav.cluster.carried import Carried
from proxnav.cluster.jobs import POOL, run_anywhere
from proxnav.cluster.progress import Progress, silent
from proxnav.datasets.skies import sky_of
from proxnav.detection.sessions import Backend
from proxnav.estimator import PoseEstimator
from proxnav.missions import Mission
from proxnav.missions.files import mission_toml
from proxnav.models.loading import carried_model, model_digest
from proxnav.targets import Target
from proxnav.targets.loading import load_target
from proxnav.trials.conditions import Condition, TrialScene, trial_scene
from proxnav.trials.drawing import draw_trial
from proxnav.trials.results import TrialResult, from_json, to_json


@dataclass(frozen=True)
class TrialJob:
    """Builds, once per process, the function from a trial scene to its answer. Can be pickled."""

    model: str | Carried
    target: Target
    others: Mapping[str, Target]
    backend: Backend = "auto"
    threads: int = 1

    def __call__(self) -> Callable[[TrialScene], TrialResult]:
        estimator = PoseEstimator.load(self.model, self.backend, self.threads)

        def answer(trial: TrialScene) -> TrialResult:
            image = draw_trial(trial, self.target, self.others)
            _, result, evidence = estimator.unjudged(image, trial.told)
            if evidence is None:
                return TrialResult.of(trial, result, result, None)
            told, evidence = estimator.compared(image, trial.told, result, evidence, sky_of(trial.scene))
            return TrialResult.of(trial, result, told, evidence)

        return answer


@dataclass(frozen=True)
class TrialRun:
    """How many frames of which conditions, and where they are drawn and kept."""

    mission: Mission
    model: str
    frames: int
    seed: int
    backend: Backend = "auto"
    workers: int = 1
    on: str = POOL
    out: Path | None = None
    progress: Progress = silent

    def results(self, conditions: Sequence[Condition]) -> list[TrialResult]:
        """All answers, condition by condition; those of an interrupted run of the same options are taken over."""
        path = self.kept
        kept = {} if path is None else _read(path)
        scenes = [
            trial_scene(condition, self.mission, self.seed, index)
            for condition in conditions
            for index in range(self.frames)
            if f"{condition.name}/{index}" not in kept
        ]
        others = {one.subject: load_target(one.subject) for one in conditions if one.shown == "other craft"}
        model = carried_model(self.model, self.on)
        threads = 0 if self.workers == 1 and self.on == POOL else 1
        job = TrialJob(model, load_target(self.mission.target), others, self.backend, threads)
        with self.progress("trials", len(scenes)) as done:
            for _, result in run_anywhere(job, scenes, self.workers, self.on, lambda trial: trial.key):
                kept[result.key] = result
                if path is not None:
                    _append(path, result)
                done()
        return [kept[f"{condition.name}/{index}"] for condition in conditions for index in range(self.frames)]

    @property
    def kept(self) -> Path | None:
        """File of the answers of this model, mission and seed, a line for each frame; more may be added."""
        if self.out is None:
            return None
        options = f"{model_digest(self.model)} {self.seed} {mission_toml(self.mission)}"
        return self.out / f"trials-{hashlib.sha256(options.encode()).hexdigest()[:12]}.jsonl"


def _read(path: Path) -> dict[str, TrialResult]:
    """Answers by key; the last line may be half written."""
    if not path.is_file():
        return {}
    found = {}
    for line in path.read_text().splitlines():
        try:
            result = from_json(json.loads(line))
        except (ValueError, KeyError):
            continue
        found[result.key] = result
    return found


def _append(path: Path, result: TrialResult) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a") as file:
        file.write(f"\n{json.dumps(to_json(result))}\n")  # a line of its own also after one that broke off
