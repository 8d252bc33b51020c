"""`proxnav report`: one HTML page of a finished run."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class ReportConfig:
    """Writes one HTML file, readable without network, of a run folder of `demo`, `benchmark table1` or `navigate`."""

    run: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RUN")]
    """Folder with poses.json, truth.json and metrics.json, or with solution.csv; what else it holds is shown."""
    out: Path | None = None
    """File to write; report.html in the run folder when not given."""
    title: str = ""
    """Heading of the page; the folder's name when not given."""


def run(config: ReportConfig) -> None:
    """Writes the page."""
    from proxnav.viewing.run_writer import write_report

    print(f"report in {write_report(config.run, config.title or config.run.resolve().name, config.out)}")
