"""Estimates and Monte Carlo runs are the same on Ray as in one process."""

import json
from pathlib import Path

import numpy as np
import pytest

from proxnav.benchmarks.monte_carlo import Case, RunJob
from proxnav.cli.main import main
from proxnav.cluster.carried import Carried
from proxnav.cluster.jobs import run_anywhere
from proxnav.estimation import SceneEstimateJob
from proxnav.flight.simulate import SensingConfig, SimulationConfig
from proxnav.flight.truth import TruthConfig
from proxnav.missions import fly, load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.navigation.config import NavigationConfig
from proxnav.targets.loading import load_target

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]


@pytest.fixture(autouse=True)
def workers_find_proxnav(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("ray", reason="needs pip install 'proxnav[cluster]'")
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2] / "src"))


def test_estimates_are_the_same_bytes_in_one_process_in_two_and_on_ray(tmp_path: Path) -> None:
    render = ["render", "--renderer", "raycast", "--frames", "3", "--size", "256", "--out", str(tmp_path / "set")]
    assert main(render) == 0
    (tmp_path / "set" / "images" / "img000001.png").write_bytes(b"torn")
    shipped = Path(__file__).parents[2] / "src" / "proxnav" / "weights" / "space-rider"
    ways = {
        "one": ["--threads", "1"],
        "two": ["--workers", "2"],
        "ray": ["--workers", "2", "--on", "ray", "--model", str(shipped)],  # a folder, which travels
    }
    for name, words in ways.items():
        out = str(tmp_path / f"{name}.json")
        assert main(["estimate", str(tmp_path / "set"), "--out", out, "--backend", "onnxruntime", *words]) == 0
    contents = {(tmp_path / f"{name}.json").read_bytes() for name in ways}
    assert len(contents) == 1
    assert json.loads(contents.pop())[1]["status"] == "bad_image"


def test_looks_at_scenes_are_the_same_in_two_processes_and_on_ray() -> None:
    shipped = Path(__file__).parents[2] / "src" / "proxnav" / "weights" / "space-rider-fast"
    mission = load_mission("observation-10-100m")
    scenes = draw_scenes(mission, 3, 5, 256)
    found = []
    for on, model in (("pool", "space-rider-fast"), ("ray", Carried.of(shipped))):
        job = SceneEstimateJob(model, load_target(mission.target), "onnxruntime")
        seen = {scene.index: result for scene, result in run_anywhere(job, scenes, 2, on)}
        found.append([(keypoints.pixels, result.status) for _, (keypoints, result) in sorted(seen.items())])
    for (pixels, status), (others, other) in zip(*found, strict=True):
        np.testing.assert_array_equal(pixels, others)
        assert status == other


def test_monte_carlo_runs_are_the_same_on_ray() -> None:
    job = RunJob(
        fly("spiral-10-100m"), 60.0, "space-rider", load_mission("spiral-10-100m").camera,
        SimulationConfig(TruthConfig(step_s=0.5), SensingConfig()), NavigationConfig(),
    )  # fmt: skip
    cases = [Case("short", seed) for seed in (1, 2)]
    here, there = (
        {case.seed: result for case, result in run_anywhere(job, cases, workers, on)}
        for workers, on in ((1, "pool"), (2, "ray"))
    )
    for seed in (1, 2):
        assert np.isfinite(here[seed].errors).any()
        for name in ("errors", "sigmas", "nees", "status"):
            np.testing.assert_array_equal(getattr(here[seed], name), getattr(there[seed], name))
