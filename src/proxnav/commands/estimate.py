"""`proxnav estimate`: images or a data set to poses.json."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from proxnav.commands.progress import progress
from proxnav.datasets.dataset import Dataset, read_image
from proxnav.datasets.files import check_new_file, inside
from proxnav.datasets.speed import PoseRecord, write_poses
from proxnav.detection.sessions import Backend
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.geometry import Camera

_IMAGES = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pgm"}


@dataclass(frozen=True)
class EstimateConfig:
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


def main(argv: list[str]) -> None:
    """Entry of `proxnav estimate`."""
    config = tyro.cli(EstimateConfig, args=argv, prog="proxnav estimate")
    check_new_file(config.out)
    images = find_images(config.input)
    camera = Camera.from_speed_json(str(config.camera or _camera_of(config.input)))
    estimator = PoseEstimator.load(config.model, config.backend, config.threads)
    records = estimate_images(estimator, images, camera)
    write_poses(config.out, records)
    found = sum(record.T_cam_target is not None for record in records)
    print(f"{found} poses from {len(records)} images in {config.out}")


def estimate_images(estimator: PoseEstimator, images: Sequence[Path], camera: Camera) -> list[PoseRecord]:
    """One record per image, in order; an image that cannot be read gets the status bad_image."""
    records = []
    with progress("estimate", len(images)) as done:
        for path in images:
            records.append(_estimate(estimator, path, camera))
            done()
    return records


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


def _estimate(estimator: PoseEstimator, path: Path, camera: Camera) -> PoseRecord:
    try:
        image = read_image(path)
    except InputError:
        return PoseRecord(path.name, None, "bad_image")
    try:
        result = estimator(image, camera)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return PoseRecord(path.name, result.T_cam_target, result.status, result.covariance)


def _camera_of(source: Path) -> Path:
    """camera.json beside the images or one folder above them."""
    folder = source if source.is_dir() else source.parent
    for candidate in (folder / "camera.json", folder.parent / "camera.json"):
        if candidate.is_file():
            return candidate
    raise InputError(f"{source}: no camera.json beside the images; give it with --camera")
