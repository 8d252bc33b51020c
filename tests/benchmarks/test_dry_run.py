"""Long jobs say what they would take, and leave nothing behind."""

import re
from pathlib import Path

import pytest

from proxnav.cli.main import main
from proxnav.cluster.forecast import Forecast, duration, size


def test_a_forecast_reads_well() -> None:
    assert Forecast(120.0, 2.001e9).text("it") == "dry run: it would take about 2.0 min and 2.0 GB of disk here"
    assert [duration(s) for s in (0.4, 99.0, 7300.0)] == ["0.4 s", "99 s", "2.0 h"]
    assert [size(b) for b in (10.0, 9.6e5, 1e9)] == ["0.0 kB", "960 kB", "1.0 GB"]


@pytest.mark.slow
@pytest.mark.parametrize("frames", [4, 400])
def test_rendering_is_estimated_in_proportion_and_writes_nothing(frames: int, tmp_path: Path, capsys) -> None:
    words = ["--renderer", "raycast", "--size", "64", "--frames", str(frames), "--out", str(tmp_path / "set")]
    assert main(["render", *words, "--dry-run"]) == 0
    said = re.search(
        rf"{frames} frames would take about ([\d.]+) (s|min|h) and ([\d.]+) (kB|MB)", capsys.readouterr().out
    )
    assert said is not None
    assert not (tmp_path / "set").exists()
    disk = float(said[3]) * {"kB": 1e3, "MB": 1e6}[said[4]]
    assert 2e3 < disk / frames < 40e3  # bytes of a frame of 64 px with its mask and label


@pytest.mark.slow
def test_training_is_estimated_and_writes_nothing(tmp_path: Path, capsys) -> None:
    pytest.importorskip("torch", reason="torch is not installed (pip install 'proxnav[train]')")
    words = ["--side", "64", "--out", str(tmp_path / "run"), "--training.loop.steps", "50"]
    assert main(["train", "finder", *words, "--training.loop.batch-size", "2", "--dry-run"]) == 0
    assert "50 steps of 2 samples would take about" in capsys.readouterr().out
    assert not (tmp_path / "run").exists()
