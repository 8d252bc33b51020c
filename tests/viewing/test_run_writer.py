"""What a run leaves in its folder."""

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from proxnav.evaluation.judgement import judge, truth_of
from proxnav.records import Keypoints
from proxnav.viewing.report import report_html
from proxnav.viewing.run_writer import write_run

KINDS = ("best", "median", "worst")


@dataclass(frozen=True)
class Options:
    out: Path
    seed: int


def test_a_run_folder_says_what_was_asked_and_forgets_the_overlays_of_the_run_before(six, tmp_path):
    """Reports pair overlays with frames by place: those of an earlier, longer run would show other frames."""
    (tmp_path / "overlays").mkdir()
    (tmp_path / "overlays" / "worst-0099.png").write_bytes(b"of an earlier run")
    (tmp_path / "overlays" / "mine.png").write_bytes(b"of the user")
    nothing = Keypoints.none("no_target", 24)
    records = [replace(record, status="ok") for record in truth_of(six)]
    write_run(tmp_path, judge(records, six), six, np.zeros((24, 3)), [nothing] * 6, Options(Path("here"), seed=7))
    names = {path.name for path in (tmp_path / "overlays").iterdir()}
    assert names == {"mine.png", *(f"{kind}-{n:04d}.png" for n, kind in enumerate(np.repeat(KINDS, 2)))}
    config = json.loads((tmp_path / "config.json").read_text())
    assert config["seed"] == 7
    assert config["options"]["out"] == "here"
    assert config["versions"]["numpy"] == np.__version__
    assert "options.seed" in report_html(tmp_path, "run")
