"""Runs that can be reported and played."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.run_folders import write_run_folder

from proxnav.cli.main import main
from proxnav.datasets.formats.speed_poses import read_poses
from proxnav.evaluation.run_frames import FrameNote, RunFrames, write_run_frames
from proxnav.geometry import Camera
from proxnav.images.codecs import encode_png
from proxnav.storage.files import write_atomic, write_json
from proxnav.targets.loading import load_target

CAMERA = Camera(96, 80, 130.0, 131.0, 47.0, 41.0)
TARGET = load_target("space-rider")


@pytest.fixture
def make_run(tmp_path: Path, rng: np.random.Generator) -> Callable[..., Path]:
    """make_run(frames, names=None, side=64, pictures=3): frame 1 has no pose, frame 2 is a half turn, if there are."""

    def make(frames: int, names: list[str] | None = None, side: int = 64, pictures: int = 3) -> Path:
        names = names or [f"{k:06d}.png" for k in range(frames)]
        return write_run_folder(tmp_path / f"run-{frames}", rng, names, side, pictures)

    return make


@pytest.fixture
def playable(make_run: Callable[..., Path], rng: np.random.Generator) -> Path:
    """Five frames, 2 s apart: frame 1 has no pose; each keypoint was found 1 px right of the truth, the first never."""
    return _playable(make_run(5), rng)


@pytest.fixture
def playable_long(make_run: Callable[..., Path], rng: np.random.Generator) -> Path:
    """The same with 25 frames, enough for running medians."""
    return _playable(make_run(25), rng)


def _playable(folder: Path, rng: np.random.Generator) -> Path:
    """Adds frames.json and a folder of images to a run."""
    notes = []
    for k, (name, record) in enumerate(read_poses(folder / "truth.json").items()):
        assert record.T_cam_target is not None
        true = CAMERA.project(record.T_cam_target @ TARGET.keypoints_m)
        found = true + np.array([1.0, 0.0])
        found[0] = np.nan
        covariances = np.tile(np.diag([4.0, 1.0]), (len(true), 1, 1))
        scores = np.where(np.isfinite(found[:, 0]), 0.9, 0.0)
        notes.append(FrameNote(name, 2.0 * k, 0.5, 0.1, 0.02, found, scores, covariances))
        image = rng.integers(0, 256, (CAMERA.height, CAMERA.width), dtype=np.uint8)
        write_atomic(folder / "set" / "images" / name, encode_png(image))
    write_json(folder / "set" / "annotations.json", {})
    run = RunFrames(tuple(notes), CAMERA, TARGET.keypoints_m, "space-rider", "2024-11-01T00:30:00Z", folder / "set")
    write_run_frames(folder, run)
    return folder


@pytest.fixture(scope="session")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """12 s of the approach through the filter."""
    folder = tmp_path_factory.mktemp("flight")
    assert main(["simulate", "--out", str(folder), "--preset", "approach-100-10m", "--duration-s", "12"]) == 0
    assert main(["navigate", str(folder)]) == 0
    return folder
