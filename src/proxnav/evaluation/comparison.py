"""Estimates of any format beside the truth of any format, in every dialect of scores that both allow."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from proxnav.datasets.formats import Labels, ReadOptions, read_labels
from proxnav.datasets.formats.pose_bowl import is_pose_bowl, read_pose_bowl
from proxnav.datasets.formats.read import pose_records, timed
from proxnav.datasets.formats.same_images import at_times_of, named_as
from proxnav.evaluation.consistency import Consistency, consistency
from proxnav.evaluation.error_tables import consistency_line, range_table, score_table, table1
from proxnav.evaluation.metrics import metrics
from proxnav.evaluation.object_model import ObjectModel, bop_model
from proxnav.evaluation.pairing import PairedFrame, pair
from proxnav.evaluation.pose_bowl import PoseBowlScore, pose_bowl_score
from proxnav.evaluation.recall import recalls
from proxnav.evaluation.summary import Summary, by_range, summarise_frames
from proxnav.evaluation.surface_errors import SurfaceScores, surface_scores
from proxnav.evaluation.trajectory_errors import TrajectoryErrors, trajectory_errors
from proxnav.geometry import Camera
from proxnav.storage.files import finite
from proxnav.storage.tables import read_rows

_TRAJECTORIES = ("tum", "solution")


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """Errors of estimates and what each dialect makes of them."""

    frames: tuple[PairedFrame, ...]
    summary: Summary
    consistency: Consistency | None
    recall: dict[str, float]
    surface: SurfaceScores | None
    """None where no surface is known."""
    trajectory: TrajectoryErrors | None
    """None where the records have no times."""

    @property
    def spark_score(self) -> float:
        """Mean position error [m] plus mean attitude error [rad]."""
        return self.summary.combined["e_t [m] + e_r [rad]"]

    def metrics(self) -> dict[str, Any]:
        """The numbers of `evaluate --json`."""
        scores = {"spark": self.spark_score, "recall": self.recall}
        scores["surface"] = None if self.surface is None else asdict(self.surface)
        scores["trajectory"] = None if self.trajectory is None else asdict(self.trajectory)
        return metrics(self.summary, self.consistency) | {"scores": finite(scores)}

    def text(self) -> str:
        """The study's Table 1 beside ours, errors by range, scores in other dialects, honesty."""
        scores = score_table(self.spark_score, self.recall, self.surface, self.trajectory)
        tables = (table1(self.summary), range_table(by_range(self.frames)), scores)
        return "\n\n".join((*tables, consistency_line(self.consistency)))


def compare(
    estimates: Path, truth: Path, model: ObjectModel | None, camera: Camera | None, object_id: int | None,
    within: Sequence[str],
) -> Comparison:  # fmt: skip
    """Reads both and pairs them; the surface is `model`, else that of a BOP set that the truth is."""
    options = ReadOptions(camera=camera, object_id=object_id)
    found, known = read_labels(estimates, options=options), read_labels(truth, options=options)
    frames = pair(_paired_names(known, found, truth, estimates), _records(known, found, truth))
    if model is None and known.format == "bop":
        model = bop_model(truth, object_id or 1)
    surface = None if model is None else surface_scores(frames, model, camera or known.camera)
    trajectory = trajectory_errors(frames) if _is_timed(known, found) else None
    return Comparison(
        frames, summarise_frames(frames), consistency(frames), recalls(frames, within), surface, trajectory
    )


def pose_bowl_files(estimates: Path, truth: Path) -> PoseBowlScore | None:
    """Score of two Pose Bowl tables; None where these are none."""
    if truth.suffix.lower() != ".csv" or not truth.is_file() or not is_pose_bowl(read_rows(truth)[0]):
        return None
    return pose_bowl_score(read_pose_bowl(estimates), read_pose_bowl(truth))


def _is_timed(known: Labels, found: Labels) -> bool:
    return known.format in _TRAJECTORIES or found.format in _TRAJECTORIES


def _records(known: Labels, found: Labels, source: Path) -> dict[str, Any]:
    records = pose_records(timed(known) if _is_timed(known, found) else known, str(source))
    return {name: replace(record, filename=name) for name, record in records.items()}


def _paired_names(known: Labels, found: Labels, truth: Path, estimates: Path) -> dict[str, Any]:
    """The estimates under the names of the truth."""
    theirs = _records(known, found, truth)
    if _is_timed(known, found):
        return at_times_of(theirs, pose_records(timed(found), str(estimates)))
    return named_as(theirs, pose_records(found, str(estimates)))
