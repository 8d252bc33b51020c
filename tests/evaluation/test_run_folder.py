"""A run folder read back: errors, order, overlays, and what is refused."""

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.run_folders import write_run_folder

from proxnav.errors import InputError
from proxnav.evaluation.pairing import from_best_to_worst
from proxnav.evaluation.run_folder import read_run, telling
from proxnav.geometry.perturbation import difference
from proxnav.storage.files import write_json


@pytest.fixture
def make_run(tmp_path: Path, rng: np.random.Generator) -> Callable[..., Path]:
    """make_run(frames, pictures=3)."""

    def make(frames: int, pictures: int = 3) -> Path:
        names = [f"{k:06d}.png" for k in range(frames)]
        return write_run_folder(tmp_path / f"run-{frames}", rng, names, 64, pictures)

    return make


def test_errors_are_those_under_the_claimed_covariance(make_run) -> None:
    for frame in read_run(make_run(20)).frames:
        if frame.T_est is None:
            assert np.isnan([frame.nees, *frame.normalised, *frame.difference]).all()
            continue
        error = difference(frame.T_est, frame.T_true)
        assert frame.nees == pytest.approx(error @ np.linalg.solve(frame.covariance, error), rel=1e-9)
        np.testing.assert_allclose(frame.normalised, error / np.sqrt(np.diagonal(frame.covariance)), rtol=1e-9)


def test_frames_without_a_pose_come_last(make_run) -> None:
    frames = read_run(make_run(8)).frames
    last = [frames[k].filename for k in from_best_to_worst(frames)[-2:]]
    assert last == ["000002.png", "000001.png"]  # half turn, then no pose


def test_pictures_run_from_worst_to_best_and_foreign_files_are_left_alone(make_run) -> None:
    folder = make_run(8, pictures=5)
    shutil.copy(folder / "overlays" / "best-0000.png", folder / "overlays" / "sketch.png")
    assert [picture.place for picture in read_run(folder).pictures] == [4, 3, 2, 1, 0]


@pytest.mark.parametrize("name", ["poses.json", "truth.json", "metrics.json"])
def test_a_missing_file_is_named(make_run, name: str) -> None:
    folder = make_run(4)
    (folder / name).unlink()
    with pytest.raises(InputError, match=name):
        read_run(folder)


def test_metrics_that_are_no_object_are_refused(make_run) -> None:
    folder = make_run(4)
    write_json(folder / "metrics.json", [1, 2])
    with pytest.raises(InputError, match=r"metrics\.json"):
        read_run(folder)


def test_an_estimate_without_truth_is_refused(make_run) -> None:
    folder, other = make_run(4), make_run(5)
    shutil.copy(other / "poses.json", folder / "poses.json")
    with pytest.raises(InputError, match=r"000004\.png"):
        read_run(folder)


@pytest.mark.parametrize("frames", range(1, 40))
def test_telling_frames_are_named_once_and_of_three_kinds(frames):
    order = np.random.default_rng(frames).permutation(frames).tolist()
    named = telling(order, 10)
    places = [int(Path(name).stem.split("-")[1]) for name, _ in named]
    kinds = [name.split("-")[0] for name, _ in named]
    assert len(set(places)) == len(named) == min(frames, 30)
    assert [order[place] for place in places] == [index for _, index in named]
    assert {"best", "median", "worst"} == set(kinds) or frames < 3
    counts = [kinds.count(kind) for kind in ("best", "median", "worst")]
    assert max(counts) - min(counts) <= 1
    assert max(places, default=0) == frames - 1 or frames < 2
    assert places[0] == 0
