"""`proxnav estimate`: images or a data set to poses.json."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from proxnav.cli.options import WorkerOptions
from proxnav.cli.progress import progress, say_when_compiling
from proxnav.cluster.jobs import POOL
from proxnav.commands.estimate_jobs import bad_image, estimate_anywhere, observe
from proxnav.datasets.formats.speed_poses import PoseRecord, write_poses
from proxnav.datasets.set.dataset import Dataset
from proxnav.detection.sessions import Backend
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.geometry import Camera
from proxnav.images.codecs import read_image
from proxnav.records import Keypoints
from proxnav.storage.files import check_new_file, inside

_IMAGES = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pgm"}


@dataclass(frozen=True)
class EstimateConfig(WorkerOptions):
    """Estimates the pose of the target in every image and writes poses.json (SPEED+ keys, status, covariance)."""

    input: Annotated[Path, tyro.conf.Positional]
    """A data set, a folder of images, or one image."""
    out: Path = Path("poses.json")
    """File to write."""
    model: str = "space-rider"
    """Name of a shipped model, or a folder with a model.json."""
    camera: Path | None = None
    """camera.json (SPEED+ keys); the data set's own when not given."""
    backend: Backend = "auto"
    """What runs the network."""
    threads: int = 0
    """For the network; 0 takes all cores."""
    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""


def run(config: EstimateConfig) -> None:
    """Entry of `proxnav estimate`."""
    check_new_file(config.out)
    images = find_images(config.input)
    camera = Camera.from_speed_json(str(config.camera or _camera_of(config.input)))
    if config.dry_run:
        print(dry_run(images, camera, config))
        return
    found = observe_anywhere(images, camera, config.model, config.backend, config.workers, config.on, config.threads)
    records = found[0]
    write_poses(config.out, records)
    poses = sum(record.T_cam_target is not None for record in records)
    print(f"{poses} poses from {len(records)} images in {config.out}")


def observe_anywhere(
    images: Sequence[Path], camera: Camera, model: str, backend: Backend, workers: int, on: str, threads: int = 0
) -> tuple[list[PoseRecord], list[Keypoints]]:
    """One record and its keypoints per image, in order; `threads` are those of a single process."""
    if workers == 1 and on == POOL:
        return observe_images(PoseEstimator.load(model, backend, threads), images, camera)
    return estimate_anywhere(images, camera, model, backend, workers, on)


def observe_images(
    estimator: PoseEstimator, images: Sequence[Path], camera: Camera
) -> tuple[list[PoseRecord], list[Keypoints]]:
    """In this process; an image that cannot be read gets the status bad_image."""
    say_when_compiling("pose")
    records, keypoints = [], []
    with progress("estimate", len(images)) as done:
        for path in images:
            record, found = _estimate(estimator, path, camera)
            records.append(record)
            keypoints.append(found)
            done()
    return records, keypoints


def find_images(source: Path) -> list[Path]:
    """The images that `source` names, sorted by name or in the data set's order."""
    if (source / "annotations.json").is_file():
        return [inside(source / "images", label.filename) for label in Dataset(source).labels]
    if source.is_dir():
        images = sorted(path for path in source.iterdir() if path.suffix.lower() in _IMAGES)
        if not images:
            raise InputError(f"{source}: holds no images; give a data set, a folder of images or an image file")
        return images
    if source.is_file():
        return [source]
    raise InputError(f"{source}: no such file or folder; give a data set, a folder of images or an image file")


def _estimate(estimator: PoseEstimator, path: Path, camera: Camera) -> tuple[PoseRecord, Keypoints]:
    try:
        image = read_image(path)
    except InputError:
        return bad_image(path.name, estimator)
    return observe(estimator, image, camera, str(path))


def dry_run(images: Sequence[Path], camera: Camera, config: EstimateConfig) -> str:
    """Measured on three images after one that is not counted; a pose takes 2 kB."""
    from proxnav.commands.dry_run import Estimate, seconds_each

    threads = config.threads if config.workers == 1 else 1
    estimator = PoseEstimator.load(config.model, config.backend, threads)
    each = seconds_each(lambda path: _estimate(estimator, path, camera), images)
    lanes = max(1, min(config.workers, os.cpu_count() or 1))
    return Estimate(each * len(images) / lanes, 2e3 * len(images)).text(f"{len(images)} images")


def _camera_of(source: Path) -> Path:
    """camera.json beside the images or one folder above them."""
    folder = source if source.is_dir() else source.parent
    for candidate in (folder / "camera.json", folder.parent / "camera.json"):
        if candidate.is_file():
            return candidate
    raise InputError(f"{source}: no camera.json beside the images; give it with --camera")
