"""`proxnav report`: a page of a run folder, or one sentence."""

import json

import pytest

from proxnav.cli.main import main

POSE = {"filename": "a.png", "q_vbs2tango_true": [1, 0, 0, 0], "r_Vo2To_vbs_true": [0, 0, 20]}


@pytest.fixture
def run(tmp_path):
    folder = tmp_path / "run"
    folder.mkdir()
    for name, content in (("poses", [POSE]), ("truth", [POSE]), ("metrics", {"frames": 1, "poses": 1})):
        (folder / f"{name}.json").write_text(json.dumps(content))
    return folder


def test_the_page_is_written_beside_the_run_or_where_told(run, tmp_path, capsys):
    assert main(["report", str(run)]) == 0
    assert main(["report", str(run), "--out", str(tmp_path / "deep" / "page.html"), "--title", "flight 7"]) == 0
    assert "<title>run</title>" in (run / "report.html").read_text()
    assert "<title>flight 7</title>" in (tmp_path / "deep" / "page.html").read_text()
    assert "page.html" in capsys.readouterr().out


@pytest.mark.parametrize("missing", ["poses.json", "truth.json", "metrics.json"])
def test_a_run_without_a_part_is_one_sentence(run, missing, capsys):
    (run / missing).unlink()
    assert main(["report", str(run)]) == 1
    error = capsys.readouterr().err
    assert missing in error
    assert len(error.splitlines()) == 1
