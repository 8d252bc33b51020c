"""`proxnav estimate`: images or a data set to poses.json."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from proxnav.cli.options import ModelOptions, WorkerOptions
from proxnav.cli.progress import progress, say_when_compiling
from proxnav.datasets.formats.speed_poses import write_poses
from proxnav.datasets.set.dataset import Dataset
from proxnav.errors import InputError
from proxnav.estimation import estimate_images
from proxnav.geometry import Camera
from proxnav.storage.files import check_new_file

_IMAGES = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pgm"}


@dataclass(frozen=True)
class EstimateConfig(ModelOptions, WorkerOptions):
    """Estimates the pose of the target in every image and writes poses.json (SPEED+ keys, status, covariance)."""

    input: Annotated[Path, tyro.conf.Positional]
    """A data set, a folder of images, or one image."""
    out: Path = Path("poses.json")
    """File to write."""
    camera: Path | None = None
    """camera.json (SPEED+ keys); the data set's own when not given."""
    threads: int = 0
    """For the network; 0 takes all cores."""


def run(config: EstimateConfig) -> None:
    """Entry of `proxnav estimate`."""
    check_new_file(config.out)
    images = find_images(config.input)
    camera = Camera.from_speed_json(str(config.camera or _camera_of(config.input)))
    say_when_compiling("pose")
    with progress("estimate", len(images)) as done:
        records, _ = estimate_images(
            images, camera, config.model, config.backend, config.threads, config.workers, config.on, done
        )
    write_poses(config.out, records)
    poses = sum(record.T_cam_target is not None for record in records)
    print(f"{poses} poses from {len(records)} images in {config.out}")


def find_images(source: Path) -> list[Path]:
    """The images that `source` names, sorted by name or in the data set's order."""
    if (source / "annotations.json").is_file():
        return Dataset(source).image_paths
    if source.is_dir():
        images = sorted(path for path in source.iterdir() if path.suffix.lower() in _IMAGES)
        if not images:
            raise InputError(f"{source}: holds no images; give a data set, a folder of images or an image file")
        return images
    if source.is_file():
        return [source]
    raise InputError(f"{source}: no such file or folder; give a data set, a folder of images or an image file")


def _camera_of(source: Path) -> Path:
    """camera.json beside the images or one folder above them."""
    folder = source if source.is_dir() else source.parent
    for candidate in (folder / "camera.json", folder.parent / "camera.json"):
        if candidate.is_file():
            return candidate
    raise InputError(f"{source}: no camera.json beside the images; give it with --camera")
