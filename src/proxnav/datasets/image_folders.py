"""The images that a path names, and the camera that lies beside them."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from proxnav.datasets.set.dataset import Dataset
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.images.codecs import image_size

SUFFIXES = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pgm"}
"""Ends of the names of image files."""
_VIDEOS = {".avi", ".mp4", ".mov", ".mkv", ".webm", ".m4v", ".mpg", ".mpeg", ".wmv", ".h264", ".ts"}


def find_images(source: Path) -> list[Path]:
    """The image files of a data set in its order, of a folder by name, or the one that `source` is."""
    if (source / "annotations.json").is_file():
        return Dataset(source).image_paths
    if source.is_dir():
        images = sorted(path for path in source.iterdir() if path.suffix.lower() in SUFFIXES)
        if not images and any(path.suffix.lower() in _VIDEOS for path in source.iterdir()):
            raise InputError(_of_video(source, "holds videos and no images"))
        if not images:
            raise InputError(f"{source}: holds no images; give a data set, a folder of images or an image file")
        return images
    if source.suffix.lower() in _VIDEOS and source.is_file():
        raise InputError(_of_video(source, "is a video"))
    if source.is_file():
        return [source]
    raise InputError(f"{source}: no such file or folder; give a data set, a folder of images or an image file")


def _of_video(source: Path, found: str) -> str:
    return f"{source}: {found}; proxnav live VIDEO reads it, or take its frames out: ffmpeg -i VIDEO frames/%06d.png"


@dataclass(frozen=True, slots=True)
class ImageChoice:
    """Which images fit a camera."""

    fitting: tuple[Path, ...]
    """Images of the camera's size, and those that claim none: they may be damaged."""
    other: tuple[str, ...]
    """Names with sizes of the others."""

    def note(self) -> str:
        """The images that were left out, in a line."""
        shown = ", ".join(self.other[:5]) + (", ..." if len(self.other) > 5 else "")
        return f"{len(self.other)} images are not of the camera's size and are left out: {shown}"


def fitting_images(images: Sequence[Path], camera: Camera) -> ImageChoice:
    """The images of the camera's size; InputError where none is, or none is an image at all."""
    sizes = {path: _claimed(path) for path in images}
    fitting = tuple(path for path in images if sizes[path] in (None, (camera.width, camera.height)))
    other = tuple(
        f"{path.name} ({size[0]}x{size[1]} px)" for path, size in sizes.items() if size and path not in fitting
    )
    if all(size is None for size in sizes.values()):
        raise InputError(
            f"{images[0]}: {'is no readable image' if len(images) == 1 else 'and all others are no images'}; "
            "expected PNG, JPEG, TIFF, BMP or PNM"
        )
    if other and not any(sizes[path] for path in fitting):
        raise InputError(
            f"{images[0].parent / other[0]}: the camera has {camera.width}x{camera.height} px and no image is of that "
            "size; give the --camera of these images"
        )
    return ImageChoice(fitting, other)


def _claimed(path: Path) -> tuple[int, int] | None:
    try:
        return image_size(path)
    except InputError:
        return None


def camera_beside(source: Path) -> Camera:
    """The camera.json beside the images or one folder above them."""
    folder = source if source.is_dir() else source.parent
    for candidate in (folder / "camera.json", folder.parent / "camera.json"):
        if candidate.is_file():
            return Camera.read(candidate)
    raise InputError(f"{source}: no camera.json beside the images; give it with --camera")
