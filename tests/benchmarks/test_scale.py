"""What the benchmark of scale concludes from what it measured."""

from itertools import count

import pytest

from proxnav.benchmarks.scale import rate, table, text, written
from proxnav.cli.main import main
from proxnav.errors import InputError
from proxnav.frames import FrameConfig
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes


def test_efficiency_and_prediction_follow_from_the_rates() -> None:
    found = table({"pool": {1: 4.0, 2: 8.0}, "ray": {1: 4.0, 2: 7.2}}, 100.0, nodes=(1, 100), cores=10)
    assert [row["efficiency"] for row in found["rates"]] == pytest.approx([1.0, 1.0, 1.0, 0.9])
    one, hundred = found["a_million_frames"]
    assert one["hours"] == pytest.approx(1e6 / (10 * 4.0 * 0.9) / 3600.0)
    assert (one["limit"], hundred["limit"]) == ("the nodes", "the driver")
    assert hundred["hours"] == pytest.approx(1e6 / 100.0 / 3600.0)
    assert "limited by the driver" in text(found)


def test_the_clock_runs_while_every_worker_is_busy(monkeypatch) -> None:
    monkeypatch.setattr("time.perf_counter", count().__next__)  # a second a result
    names = ["first"] * 25 + ["second"] * 2 + ["first", "second"] * 6 + ["first"]
    assert len(names) == 2 * 10 + 20
    assert rate(names, 2, 20) == 1.0
    with pytest.raises(InputError, match="1 of 2 workers"):
        rate(["first"] * 40, 2, 20)


def test_frames_are_drawn_and_written_on_the_clock(tmp_path) -> None:
    scenes = draw_scenes(load_mission("observation-10-100m"), 6, 0, 32)
    names = list(written(scenes, tmp_path, 2, "pool", FrameConfig("raycast", threads=1)))
    assert len(names) == 6
    assert len(list((tmp_path / "images").iterdir())) == 6


@pytest.mark.parametrize("words", [["--frames", "1"], ["--on", "nowhere"], ["--workers", "0"]])
def test_nonsense_is_refused(words, capsys) -> None:
    assert main(["benchmark", "scale", *words]) == 1
    assert len(capsys.readouterr().err.splitlines()) == 1
