"""The stages together: scenes to a data set, whichever process draws and however often it is killed."""

import hashlib
import json
import random
import subprocess
import sys
import time
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from jobs import Same
from proxnav.commands.demo import DemoConfig
from proxnav.datasets.set.dataset import Dataset
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.frames import FrameConfig
from proxnav.learning.crops import CropConfig, CropJob, WholeFrameJob, sample_source
from proxnav.missions import fly, load_mission
from proxnav.pipeline import draw_scenes, follow, judge, observable, render, truth_of, write_run
from proxnav.records import Keypoints
from proxnav.storage.lock import LOCK
from proxnav.viewing.report import report_html

RAYCAST = FrameConfig("raycast")
SIDE = 96


def scenes(frames, seed=3):
    return draw_scenes(load_mission("observation-10-100m"), frames, seed, SIDE)


def fingerprint(folder: Path) -> dict[str, str]:
    """Hash of every file, by its path in the folder."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@pytest.fixture(scope="module")
def six(tmp_path_factory) -> Dataset:
    """Six frames drawn without interruption by one process."""
    return render(scenes(6), RAYCAST, tmp_path_factory.mktemp("sets") / "six", 1)


def test_the_first_scenes_of_a_longer_set_are_those_of_a_shorter_one():
    assert scenes(3) == scenes(6)[:3]


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
    words = ["render", "--renderer", "raycast", "--frames", "160", "--size", "64"]
    command = [sys.executable, "-m", "proxnav.cli.main", *words]
    subprocess.run([*command, "--out", str(tmp_path / "whole")], check=True, capture_output=True)
    rng, folder = random.Random(5), tmp_path / "killed"

    def written() -> int:
        return sum(1 for _ in folder.rglob("*.json"))

    killed = 0
    while killed < 20:
        run = subprocess.Popen([*command, "--out", str(folder)], stderr=subprocess.DEVNULL)
        enough = written() + rng.randint(1, 4)
        while run.poll() is None and written() < enough:
            time.sleep(0.005)
        time.sleep(rng.uniform(0.0, 0.03))  # a moment that may fall anywhere within a frame
        if run.poll() is not None:
            break
        run.kill()
        run.wait()
        killed += 1
    subprocess.run([*command, "--out", str(folder)], check=True, capture_output=True)
    assert killed >= 10
    assert fingerprint(folder) == fingerprint(tmp_path / "whole")


def test_a_trajectory_is_followed_where_the_lit_side_shows():
    mission = load_mission("spiral-10-100m")
    trajectory = fly(mission.flight.trajectory)
    usable = observable(trajectory, mission.scenes.sun.max_phase_rad)
    assert 0.1 < usable.mean() < 0.9
    for scene in follow(trajectory, mission, 5, seed=0, size=SIDE):
        to_camera = scene.T_cam_target.inverse().t_m
        assert scene.sun.visible_fraction > 0.5
        assert np.dot(scene.sun.direction_target, to_camera) > -1e-6


def test_perfect_estimates_have_no_error(six):
    judgement = judge([replace(record, status="ok") for record in truth_of(six)], six)
    assert judgement.summary.poses == 6
    assert judgement.summary.mean_e_c < 1e-9
    assert judgement.efficiency
    assert all(one.translation < 1e-6 < one.bound_t_m for one in judgement.efficiency.values())
    assert set(judgement.metrics()["efficiency"]) == {f"{a:g}-{b:g} m" for a, b in judgement.efficiency}
    assert "Cramer-Rao" in judgement.text()


CROPS = CropConfig(load_mission("observation-10-100m").training_mission, side=64, seed=11)


def test_a_training_crop_is_a_function_of_its_number():
    first, again = CropJob(CROPS)()(5), CropJob(CROPS)()(5)
    np.testing.assert_array_equal(first.image, again.image)
    np.testing.assert_array_equal(first.keypoints_px, again.keypoints_px)


def test_a_training_crop_holds_the_target():
    make = CropJob(CROPS)()
    for index in range(4):
        sample = make(index)
        assert sample.image.shape == (64, 64)
        assert sample.has_target
        assert sample.mask is not None
        assert sample.mask.mean() > 0.01


def test_a_share_of_whole_frames_is_empty():
    make = WholeFrameJob(replace(CROPS, side=64), empty_share=0.5)()
    shown = [make(index).has_target for index in range(8)]
    assert True in shown
    assert False in shown


def test_a_stream_of_samples_can_be_entered_anywhere():
    source = sample_source(CropJob(CROPS), workers=1, repeats=2, block=4)
    whole = [sample.image for sample in islice(source(0, 1), 12)]
    late = [sample.image for sample in islice(source(5, 1), 5)]
    for image, same in zip(late, whole[5:10], strict=True):
        np.testing.assert_array_equal(image, same)
    assert not np.array_equal(whole[0], whole[8])  # after both passes comes another block


def test_ranks_draw_disjoint_samples_and_together_all_of_them():
    whole = set(range(24))
    shares = [set(islice(sample_source(Same(), workers=1, repeats=1, block=8)(rank, 2), 12)) for rank in (0, 1)]
    assert shares[0] | shares[1] == whole
    assert not shares[0] & shares[1]
    assert set(islice(sample_source(Same(), workers=1, repeats=1, block=8)(0, 1), 24)) == whole


@pytest.mark.parametrize(("frames", "seed"), [(0, 0), (-3, 0), (1, -1)])
def test_no_frames_or_a_negative_seed_is_refused_by_random_and_by_flown_scenes(frames, seed):
    mission = load_mission("spiral-10-100m")
    with pytest.raises(InputError, match="at least 1 frame"):
        draw_scenes(mission, frames, seed, SIDE)
    with pytest.raises(InputError, match="at least 1 frame"):
        follow(fly(mission.flight.trajectory), mission, frames, seed, SIDE)


def test_a_run_folder_says_what_was_asked_and_forgets_the_overlays_of_the_run_before(six, tmp_path):
    """Reports pair overlays with frames by place: those of an earlier, longer run would show other frames."""
    (tmp_path / "overlays").mkdir()
    (tmp_path / "overlays" / "worst-0099.png").write_bytes(b"of an earlier run")
    (tmp_path / "overlays" / "mine.png").write_bytes(b"of the user")
    nothing = Keypoints.none("no_target", 24)
    estimator = PoseEstimator(lambda image: nothing, np.zeros((24, 3)), ("",) * 24, "space-rider")
    records = [replace(record, status="ok") for record in truth_of(six)]
    write_run(tmp_path, judge(records, six), six, estimator, DemoConfig(seed=7, out=Path("here")))
    names = {path.name for path in (tmp_path / "overlays").iterdir()}
    assert names == {"mine.png", *(f"{kind}-{n:04d}.png" for n, kind in enumerate(np.repeat(KINDS, 2)))}
    config = json.loads((tmp_path / "config.json").read_text())
    assert config["seed"] == 7
    assert config["options"]["out"] == "here"
    assert config["versions"]["numpy"] == np.__version__
    assert "options.seed" in report_html(tmp_path, "run")


KINDS = ("best", "median", "worst")


def test_a_set_is_not_continued_by_another_renderer(six, tmp_path):
    """The frames that are there would stay, and nothing in the set would tell them from the others."""
    with pytest.raises(InputError, match="rendered with renderer raycast, not cycles"):
        render(scenes(6), FrameConfig("cycles"), six.folder, 1)
    assert len(render(scenes(6), replace(RAYCAST, samples=7), six.folder, 1)) == 6  # samples are of Cycles alone


@pytest.mark.parametrize("size", [0, -5, 10**9])
def test_an_image_of_impossible_size_is_refused(size):
    with pytest.raises(InputError, match="longer side"):
        draw_scenes(load_mission("observation-10-100m"), 1, 0, size)


@pytest.mark.parametrize(("workers", "repeats"), [(0, 1), (1, 0)])
def test_a_stream_without_workers_or_passes_is_refused_instead_of_waiting_for_ever(workers, repeats):
    with pytest.raises(InputError, match="at least 1"):
        sample_source(CropJob(CROPS), workers, repeats)
