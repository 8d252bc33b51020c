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
    """Entry of `proxnav report`."""
    from proxnav.storage.files import write_atomic
    from proxnav.viewing.report import report_html

    page = report_html(config.run, config.title or config.run.resolve().name)
    out = config.out or config.run / "report.html"
    write_atomic(out, page.encode())
    print(f"report in {out}")
