"""Scenes to a data set, whichever process draws and however often it is killed."""

import hashlib
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from boxcraft import boxcraft
from proxnav.errors import InputError
from proxnav.frames import FrameConfig
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.rendered_set import render
from proxnav.storage.lock import LOCK
from proxnav.targets.target_files import save_target

RAYCAST = FrameConfig("raycast")
SIDE = 96


def scenes(frames, seed=3):
    return draw_scenes(load_mission("observation-10-100m"), frames, seed, SIDE)


def fingerprint(folder: Path) -> dict[str, str]:
    """Hash of every file, by its path in the folder."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def test_a_data_set_shows_the_target_where_its_labels_say(six):
    for index, label in enumerate(six.labels):
        mask = six.mask(index)
        visible = label.keypoints_px[label.visibility == 2]
        column, row = np.floor(visible).astype(int).T
        near = [mask[max(r - 3, 0) : r + 4, max(c - 3, 0) : c + 4].any() for r, c in zip(row, column, strict=True)]
        assert np.mean(near) > 0.9  # the rest are thin things seen edge-on


def test_two_processes_draw_the_same_bytes_as_one(six, tmp_path):
    render(scenes(6), RAYCAST, tmp_path / "two", 2)
    assert fingerprint(tmp_path / "two") == fingerprint(six.folder)


def test_a_frame_is_drawn_again_from_its_line_alone(six, tmp_path):
    again = list(six.scenes())[4]
    render([again], RAYCAST, tmp_path / "one", 1)
    name = f"images/{again.filename}"
    assert fingerprint(tmp_path / "one")[name] == fingerprint(six.folder)[name]


def test_a_lock_that_a_killed_run_left_in_a_finished_set_is_removed(tmp_path):
    render(scenes(1), RAYCAST, tmp_path, 1)
    (tmp_path / LOCK).touch()
    render(scenes(1), RAYCAST, tmp_path, 1)
    assert not (tmp_path / LOCK).exists()


@pytest.mark.slow
def test_a_render_killed_twenty_times_ends_like_one_that_was_not(tmp_path):
    # Kills are counted in frames, not seconds: a fast machine must not be done before the twentieth.
    save_target(boxcraft(), tmp_path / "craft")
    words = ["render", "--renderer", "raycast", "--preset", "approach-100-10m", "--target", str(tmp_path / "craft")]
    words += ["--frames", "120", "--size", "64"]
    command, folder = [sys.executable, "-m", "proxnav.cli.main", *words], tmp_path / "killed"
    subprocess.run([*command, "--out", str(tmp_path / "whole")], check=True, capture_output=True)
    killing = [sys.executable, str(Path(__file__).with_name("killed_runs.py")), str(folder), *words]
    killed = subprocess.run(killing, check=True, capture_output=True, text=True).stdout.split()[-1]
    subprocess.run([*command, "--out", str(folder)], check=True, capture_output=True)
    assert int(killed) >= 10
    assert fingerprint(folder) == fingerprint(tmp_path / "whole")


def test_a_set_is_not_continued_by_another_renderer(six, tmp_path):
    """The frames that are there would stay, and nothing in the set would tell them from the others."""
    with pytest.raises(InputError, match="rendered with renderer raycast, not cycles"):
        render(scenes(6), FrameConfig("cycles"), six.folder, 1)
    assert len(render(scenes(6), replace(RAYCAST, samples=7), six.folder, 1)) == 6  # samples are of Cycles alone
