"""Many flights of one command: the same files wherever they are made, kept when they are finished."""

import json
from pathlib import Path

import pytest

from proxnav.cli.main import main
from proxnav.evaluation.flight_accuracy import mean_accuracy

pytestmark = pytest.mark.filterwarnings("ignore")
SHORT = ["--preset", "approach-100-10m", "--duration-s", "8"]


def contents(folder: Path) -> dict[str, bytes]:
    """Every file of the runs in a folder, but for their options, which name the folder."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name not in ("config.json", "simulate.json", "navigate.json")
    }


@pytest.mark.slow
def test_flights_and_their_solutions_are_the_same_alone_in_two_processes_and_on_ray(tmp_path, monkeypatch) -> None:
    pytest.importorskip("ray", reason="needs pip install 'proxnav[cluster]'")
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2] / "src"))
    ways = {"one": [], "two": ["--workers", "2"], "ray": ["--workers", "2", "--on", "ray"]}
    for name, words in ways.items():
        out = str(tmp_path / name)
        assert main(["simulate", "--out", out, *SHORT, "--runs", "2", "--seed", "4", *words]) == 0
        assert main(["navigate", out, *words]) == 0
    one = contents(tmp_path / "one")
    assert {"00004/gyro.csv", "00005/solution.csv", "00005/summary.json", "monte_carlo.json"} <= set(one)
    assert one["00004/gyro.csv"] != one["00005/gyro.csv"]
    assert contents(tmp_path / "two") == one
    assert contents(tmp_path / "ray") == one
    alone = tmp_path / "alone"
    assert main(["simulate", "--out", str(alone), *SHORT, "--seed", "5"]) == 0
    assert (alone / "poses.csv").read_bytes() == one["00005/poses.csv"]
    assert json.loads((tmp_path / "one" / "monte_carlo.json").read_text())["with_truth"] == 2


@pytest.mark.slow
def test_finished_flights_are_kept_and_other_options_refused(tmp_path, capsys) -> None:
    out = str(tmp_path / "flights")
    assert main(["simulate", "--out", out, *SHORT, "--runs", "2"]) == 0
    before = contents(tmp_path / "flights")
    stamps = {path: path.stat().st_mtime_ns for path in (tmp_path / "flights").rglob("*.csv")}
    (tmp_path / "flights" / "00001" / "config.json").unlink()  # as if it had been interrupted there
    assert main(["simulate", "--out", out, *SHORT, "--runs", "3"]) == 0
    after = contents(tmp_path / "flights")
    assert {name: after[name] for name in before} == before
    assert (tmp_path / "flights" / "00002" / "config.json").is_file()
    assert all(path.stat().st_mtime_ns == stamp for path, stamp in stamps.items() if path.parent.name == "00000")
    capsys.readouterr()
    assert main(["simulate", "--out", out, *SHORT, "--start-s", "5", "--runs", "3"]) == 1
    assert "another start_s" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [(["simulate", "--out", "x", "--runs", "0"], "--runs"), (["simulate", "--out", "x", "--on", "moon"], "pool, ray"),
     (["navigate", "x", "--workers", "0"], "--workers")],
)  # fmt: skip
def test_nonsense_is_refused(words: list[str], said: str, capsys) -> None:
    assert main(words) == 1
    assert said in capsys.readouterr().err


def test_means_are_over_the_flights_whose_truth_is_known() -> None:
    flight = {"starts": 1, "rms_position_m": [3.0, 0.0, 0.0], "rms_velocity_mps": [0.0, 1.0, 0.0],
              "rms_attitude_deg": [0.0, 0.0, 2.0], "mean_nees_of_12": 10.0, "inside_3_sigma": 1.0}  # fmt: skip
    other = flight | {"rms_position_m": [0.0, 4.0, 3.0], "starts": 2}
    found = mean_accuracy([flight, other, {"starts": 1}])
    assert (found["flights"], found["with_truth"], found["starts"]) == (3, 2, 4)
    assert found["rms_position_m"] == pytest.approx((17.0) ** 0.5)
    assert mean_accuracy([{"starts": 1}]) == {"flights": 1, "with_truth": 0, "starts": 1}


def test_the_former_spelling_of_the_detector_says_the_present_one(tmp_path: Path, capsys) -> None:
    assert main(["simulate", "--out", str(tmp_path / "run"), "--camera", "raycast"]) == 1
    assert "--detector raycast" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()
