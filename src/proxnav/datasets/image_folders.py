"""The images that a path names, and the camera that lies beside them."""

from pathlib import Path

from proxnav.datasets.set.dataset import Dataset
from proxnav.errors import InputError
from proxnav.geometry import Camera

SUFFIXES = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pgm"}
"""Ends of the names of image files."""


def find_images(source: Path) -> list[Path]:
    """The image files of a data set in its order, of a folder by name, or the one that `source` is."""
    if (source / "annotations.json").is_file():
        return Dataset(source).image_paths
    if source.is_dir():
        images = sorted(path for path in source.iterdir() if path.suffix.lower() in SUFFIXES)
        if not images:
            raise InputError(f"{source}: holds no images; give a data set, a folder of images or an image file")
        return images
    if source.is_file():
        return [source]
    raise InputError(f"{source}: no such file or folder; give a data set, a folder of images or an image file")


def camera_beside(source: Path) -> Camera:
    """The camera.json beside the images or one folder above them."""
    folder = source if source.is_dir() else source.parent
    for candidate in (folder / "camera.json", folder.parent / "camera.json"):
        if candidate.is_file():
            return Camera.read(candidate)
    raise InputError(f"{source}: no camera.json beside the images; give it with --camera")
