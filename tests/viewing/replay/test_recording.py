"""The Rerun recording is readable again and holds what was promised, on one time line."""

from pathlib import Path

import numpy as np
import pytest

from proxnav.cli.main import main
from proxnav.viewing.replay.of_run import read_replay
from proxnav.viewing.replay.rerun_recording import save_rerun

rerun = pytest.importorskip("rerun", reason="rerun-sdk is not installed (pip install 'proxnav[view]')")

ENTITIES = {
    "/world/target/mesh", "/world/target/keypoints", "/world/truth/camera", "/world/truth/camera/image",
    "/world/truth/camera/image/found", "/world/truth/camera/image/found_3_sigma", "/world/truth/camera/image/true",
    "/world/truth/path", "/world/estimate/camera", "/world/estimate/sigma", "/world/estimate/path",
}  # fmt: skip


@pytest.fixture(autouse=True)
def strict() -> None:
    """A slip in what is logged is an error, not a warning."""
    rerun.set_strict_mode(True)


def _chunks(path: Path) -> dict[str, list]:
    from rerun.chunk import RrdReader

    found: dict[str, list] = {}
    for chunk in RrdReader(str(path)).stream():
        found.setdefault(chunk.entity_path, []).append(chunk)
    return found


def test_a_run_of_images_holds_every_entity_on_one_time_line(playable: Path, tmp_path: Path) -> None:
    save_rerun(read_replay(playable), tmp_path / "run.rrd")
    chunks = _chunks(tmp_path / "run.rrd")
    assert set(chunks) >= ENTITIES
    axes = ("position/right", "position/down", "position/forward", "attitude/about_right", "attitude/about_forward")
    assert set(chunks) >= {f"/errors/{name}" for name in axes}
    assert {name for group in chunks.values() for chunk in group for name in chunk.timeline_names} == {"t"}


def test_the_viewer_is_told_the_camera_axes(playable: Path, tmp_path: Path) -> None:
    save_rerun(read_replay(playable), tmp_path / "run.rrd")
    fixed = [c for c in _chunks(tmp_path / "run.rrd")["/world/truth/camera/image"] if c.is_static]
    batch = fixed[0].to_record_batch()
    right, down, forward = 3, 2, 5  # Rerun's codes of view directions
    assert np.ravel(batch.column("Pinhole:camera_xyz").to_pylist()).tolist() == [right, down, forward]


def test_a_pose_that_is_missing_is_missing_and_times_are_seconds(playable: Path, tmp_path: Path) -> None:
    save_rerun(read_replay(playable), tmp_path / "run.rrd")
    chunks = _chunks(tmp_path / "run.rrd")
    rows = [c.to_record_batch() for c in chunks["/errors/position/right"] if not c.is_static]
    times = sorted(t.total_seconds() for batch in rows for t in batch.column("t").to_pylist())
    assert times == [0.0, 4.0, 6.0, 8.0]  # frame 1 has no pose


def test_a_flight_is_recorded_and_the_command_writes_it(flight: Path, tmp_path: Path) -> None:
    assert main(["view", str(flight), "--save", str(tmp_path / "deep" / "flight.rrd")]) == 0
    chunks = _chunks(tmp_path / "deep" / "flight.rrd")
    assert "/world/estimate/sigma" in chunks
    assert "/errors/attitude/about_target_x/3_sigma_above" in chunks


def test_without_a_display_the_next_step_is_named(playable: Path, monkeypatch, capsys) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert main(["view", str(playable)]) == 1
    assert "--save" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["run.txt", "run"])
def test_an_unknown_kind_of_file_is_one_sentence(playable: Path, tmp_path: Path, name: str, capsys) -> None:
    assert main(["view", str(playable), "--save", str(tmp_path / name)]) == 1
    assert ".mcap" in capsys.readouterr().err
    assert not (tmp_path / name).exists()
