"""Estimates of a data set beside its truth: errors, honesty of the covariances, distance from the best possible."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.datasets.set.dataset import Dataset
from proxnav.evaluation.consistency import Consistency, Efficiency, consistency, efficiency_by_range
from proxnav.evaluation.error_tables import consistency_line, efficiency_table, range_table, table1
from proxnav.evaluation.label_bounds import label_bound
from proxnav.evaluation.metrics import metrics
from proxnav.evaluation.pairing import PairedFrame, pair
from proxnav.evaluation.summary import Summary, by_range, summarise_frames

EFFICIENCY_EDGES_M = (10.0, 15.0, 25.0, 40.0, 60.0, 70.0, 90.0, 110.0)
"""Bins round 20, 50 and 80 m, and what lies between."""


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """Estimates of a data set beside its truth."""

    records: tuple[PoseRecord, ...]
    truth: tuple[PoseRecord, ...]
    frames: tuple[PairedFrame, ...]
    summary: Summary
    consistency: Consistency | None
    efficiency: Mapping[tuple[float, float], Efficiency]
    """Errors over the Cramer-Rao bound, at `EFFICIENCY_EDGES_M`."""

    def metrics(self) -> dict[str, Any]:
        """The numbers of `metrics.json`."""
        return metrics(self.summary, self.consistency, self.efficiency)

    def text(self) -> str:
        """The study's Table 1 beside ours, errors by range and over the bound, honesty of the covariances."""
        tables = (table1(self.summary), range_table(by_range(self.frames)), efficiency_table(self.efficiency))
        return "\n\n".join((*tables, consistency_line(self.consistency)))


def judge(records: Sequence[PoseRecord], dataset: Dataset) -> Judgement:
    """Errors of the estimates of a data set."""
    truth = truth_of(dataset)
    frames = pair({record.filename: record for record in records}, {record.filename: record for record in truth})
    bounds = {label.filename: label_bound(label, dataset.keypoints_m, dataset.camera) for label in dataset.labels}
    known = {name: bound for name, bound in bounds.items() if bound is not None}
    efficiency = efficiency_by_range(frames, known, EFFICIENCY_EDGES_M)
    return Judgement(tuple(records), truth, frames, summarise_frames(frames), consistency(frames), efficiency)


def truth_of(dataset: Dataset) -> tuple[PoseRecord, ...]:
    """The true poses of a data set."""
    return tuple(PoseRecord(label.filename, label.T_cam_target, "truth") for label in dataset.labels)
