"""Jobs on Ray give what they give in one process, whatever dies."""

import hashlib
import os
from collections import Counter
from pathlib import Path

import pytest

from jobs import CannotBegin, DieOnce, Fail, FailAtThree, Square, Threads
from proxnav.cluster.jobs import run_anywhere
from proxnav.datasets.set.writer import DatasetWriter
from proxnav.errors import InputError
from proxnav.frames import FrameConfig
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.rendered_set import render

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]  # Ray's own imports warn

FRAMES = int(os.environ.get("PROXNAV_CLUSTER_FRAMES", "32"))
"""500 for docs/benchmarks/scale.md: the single process that they are compared with takes minutes."""
SIDE = 48


def fingerprint(folder: Path) -> dict[str, str]:
    """Hash of every file by its path, but for the record of versions and options."""
    files = [path for path in sorted(folder.rglob("*")) if path.is_file() and path.name != "config.json"]
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def test_frames_survive_the_death_of_a_node(two_nodes, tmp_path, monkeypatch) -> None:
    scenes = draw_scenes(load_mission("observation-10-100m"), FRAMES, 3, SIDE)
    render(scenes, FrameConfig("raycast"), tmp_path / "one", 1)
    written, put = Counter(), DatasetWriter.put

    def counted(self: DatasetWriter, files: dict[str, bytes]) -> None:
        written.update(files.keys())
        put(self, files)

    def done() -> None:
        if len(written) == 3 * FRAMES // 2:
            two_nodes.kill_second()

    monkeypatch.setattr(DatasetWriter, "put", counted)
    render(scenes, FrameConfig("raycast"), tmp_path / "two", 2, done, two_nodes.address)
    assert two_nodes.second not in two_nodes.cluster.list_all_nodes()
    assert set(written.values()) == {1}
    assert len(written) == 3 * FRAMES
    assert fingerprint(tmp_path / "two") == fingerprint(tmp_path / "one")


def test_a_killed_worker_and_a_failing_job_lose_only_what_failed(two_nodes, tmp_path, capfd) -> None:
    results = dict(run_anywhere(DieOnce(tmp_path / "died"), list(range(12)), 2, two_nodes.address))
    assert results == {x: -x for x in range(12)}
    assert (tmp_path / "died").exists()
    found = {}

    def collect() -> None:
        for item, result in run_anywhere(FailAtThree(), list(range(8)), 2, two_nodes.address, "job {}".format):
            found[item] = result

    with pytest.raises(InputError, match="1 of 8 jobs failed"):
        collect()
    assert found == {x: x for x in range(8) if x != 3}
    lines = [line for line in capfd.readouterr().err.splitlines() if "failed" in line]
    assert lines == ["job 3 failed 3 times: ValueError: cannot do 3"]


def test_ray_on_this_machine_needs_no_cluster_and_says_why_nothing_works(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("PYTHONPATH", f"{Path(__file__).parents[1]}:{Path(__file__).parents[2] / 'src'}")
    assert dict(run_anywhere(Square(), list(range(20)), 2, "ray")) == {x: x * x for x in range(20)}
    assert dict(run_anywhere(Threads(), [1], 1, "ray")) == {1: (1, "1")}
    with pytest.raises(InputError, match="no tool here"):
        list(run_anywhere(CannotBegin(), [1, 2, 3], 1, "ray"))
    with pytest.raises(InputError, match="none succeeded"):
        list(run_anywhere(Fail(), list(range(30)), 1, "ray"))


@pytest.mark.parametrize("on", ["rays", "ray://", "ray://here", "http://127.0.0.1:1", "ray://127.0.0.1:x"])
def test_a_place_that_is_none_is_refused(on: str) -> None:
    with pytest.raises(InputError, match="expected pool, ray"):
        run_anywhere(Square(), [1], 1, on)
