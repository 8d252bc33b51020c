"""A disk that is full or read-only ends a run with one sentence; with room it resumes to the same bytes."""

import errno
import os
import subprocess
from collections.abc import Iterator
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path

import pytest
import torch
from tests.datasets.formats.small_sets import make_dataset
from tests.detection.test_training import CONFIG, assert_same, learner, source

from proxnav.cli.main import main
from proxnav.detection.training.loop import train
from proxnav.errors import InputError
from proxnav.frames import FrameConfig
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.rendered_set import render
from proxnav.storage import files

RAYCAST = FrameConfig("raycast")


def scenes():
    return draw_scenes(load_mission("observation-10-100m"), 4, 3, 64)


def contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of its own, of 64 KiB."""
    place = tmp_path / "disk"
    place.mkdir()
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(place)], capture_output=True)
    if made.returncode != 0:
        pytest.skip("only root may mount the small disk that this test fills")
    yield place
    subprocess.run(["umount", str(place)], check=True)


def test_a_real_disk_runs_full_and_the_run_resumes_when_there_is_room(small_disk: Path, tmp_path: Path, capsys) -> None:
    whole = render(scenes(), RAYCAST, tmp_path / "whole", 1).folder
    (small_disk / "ballast").write_bytes(bytes(40_000))
    words = ["render", "--renderer", "raycast", "--frames", "4", "--seed", "3", "--size", "64"]
    assert main([*words, "--out", str(small_disk / "set")]) == 1
    said = [line for line in capsys.readouterr().err.splitlines() if line.startswith("proxnav")]
    assert len(said) == 1
    assert "no room left" in said[0]
    assert "resumes" in said[0]
    assert not list(small_disk.rglob("*.part"))
    (small_disk / "ballast").unlink()
    subprocess.run(["mount", "-o", "remount,size=4m", str(small_disk)], check=True)
    assert main([*words, "--out", str(small_disk / "set")]) == 0
    here, there = contents(small_disk / "set"), contents(whole)
    assert here.pop("mission.toml")  # the command's own, the frames beside it are those of `render`
    assert here.keys() == there.keys()
    assert all(here[name] == there[name] for name in here if name != "config.json")


def test_a_read_only_disk_is_one_sentence(small_disk: Path, capsys) -> None:
    subprocess.run(["mount", "-o", "remount,ro", str(small_disk)], check=True)
    words = ["render", "--renderer", "raycast", "--frames", "1", "--size", "64", "--out", str(small_disk / "set")]
    assert main(words) == 1
    assert "Read-only file system" in capsys.readouterr().err
    with pytest.raises(InputError, match="Read-only"):
        train(learner(), source, CONFIG, small_disk / "run")


@pytest.mark.parametrize("call", range(1, 14))
def test_wherever_the_disk_runs_full_a_set_resumes_to_the_same_bytes(call: int, tmp_path: Path, monkeypatch) -> None:
    """The file layer refuses its `call`-th file: camera, target, scenes, frames or the annotations at the end."""
    written, replacing = 0, files.replacing

    def full(path: Path) -> AbstractContextManager[Path]:
        nonlocal written
        written += 1
        if written == call:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        return replacing(path)

    with monkeypatch.context() as patched:
        patched.setattr(files, "replacing", full)
        if call <= 10:
            with pytest.raises(InputError, match="no room left"):
                make_dataset(tmp_path / "cut", 2)
        else:
            make_dataset(tmp_path / "cut", 2)
            assert written == 10  # camera, target, scenes, two frames of three files, annotations
    make_dataset(tmp_path / "cut", 2)
    assert contents(tmp_path / "cut") == contents(make_dataset(tmp_path / "whole", 2))


def test_a_training_whose_disk_is_full_keeps_its_checkpoint_and_resumes(tmp_path: Path, monkeypatch) -> None:
    whole = train(learner(), source, CONFIG, tmp_path / "whole")
    train(learner(), source, replace(CONFIG, steps=6), tmp_path / "cut")

    def full(content: dict, path: Path) -> None:
        path.write_bytes(b"half")
        raise RuntimeError("[enforce fail at inline_container.cc:659] . unexpected pos 64 vs 0")

    with monkeypatch.context() as patched:
        patched.setattr(torch, "save", full)
        with pytest.raises(InputError, match="is the disk full"):
            train(learner(), source, replace(CONFIG, save_every=3), tmp_path / "cut")
    resumed = train(learner(), source, CONFIG, tmp_path / "cut")
    assert_same(whole.model.state_dict(), resumed.model.state_dict())
