"""`proxnav evaluate`: poses against truth."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class EvaluateConfig:
    """Compares poses with the truth and prints the study's Table 1 beside these, then the errors by range."""

    estimates: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="ESTIMATES")]
    """poses.json of `proxnav estimate` or `proxnav solve`, or any other format that `proxnav convert` reads."""
    truth: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="TRUTH")]
    """A data set folder, or labels in any such form; images without an estimate count as frames without a pose."""
    json: bool = False
    """Print one JSON object instead of the tables."""


def run(config: EvaluateConfig) -> None:
    """Reads, compares, prints."""
    from proxnav.datasets.formats import read_pose_records
    from proxnav.datasets.formats.same_images import named_as
    from proxnav.evaluation.consistency import consistency
    from proxnav.evaluation.error_tables import consistency_line, range_table, table1
    from proxnav.evaluation.metrics import metrics
    from proxnav.evaluation.pairing import pair
    from proxnav.evaluation.summary import by_range, summarise_frames

    estimates, truth = read_pose_records(config.estimates), read_pose_records(config.truth)
    frames = pair(named_as(truth, estimates), truth)
    summary, found = summarise_frames(frames), consistency(frames)
    if config.json:
        print(json.dumps(metrics(summary, found), indent=1))
        return
    print(table1(summary))
    print(f"\n{range_table(by_range(frames))}")
    print(f"\n{consistency_line(found)}")
