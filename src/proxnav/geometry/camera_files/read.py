"""Any calibration file as a camera: which kind it is shows in its content."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from proxnav.errors import InputError
from proxnav.geometry.camera import Camera
from proxnav.geometry.camera_files import kalibr_camchain, matlab_camera, opencv_matrices, plain_numbers, speed_camera
from proxnav.geometry.camera_files.documents import read_document
from proxnav.geometry.camera_files.fields import Fields
from proxnav.geometry.lens_reach import lens_reach

_KINDS: tuple[tuple[Callable[[Fields], bool], Callable[[Fields], tuple[Camera, tuple[str, ...]]]], ...] = (
    (speed_camera.is_one, speed_camera.read_speed),
    (kalibr_camchain.is_one, kalibr_camchain.read_kalibr),
    (matlab_camera.is_one, matlab_camera.read_matlab),
    (opencv_matrices.is_one, opencv_matrices.read_matrices),
    (plain_numbers.is_one, plain_numbers.read_plain),
)
_EXPECTED = (
    "expected camera_matrix (OpenCV, ROS), intrinsics (Kalibr), IntrinsicMatrix (MATLAB), K and dist (npz), Nu, Nv and "
    "cameraMatrix (SPEED+), or fx, fy, cx, cy, width and height"
)
_LEAST_SEEN = 0.5
"""Share of the image to which rays must lead."""
_OUTSIDE = 0.5
"""Principal points further outside the image than this share of it are taken for a mistake."""


@dataclass(frozen=True, slots=True)
class CameraFile:
    """A camera and what its reader has to say."""

    camera: Camera
    notes: tuple[str, ...]
    """What was converted or assumed, one clause each."""


def read_camera_file(path: str | Path) -> CameraFile:
    """The camera of a calibration file, corner-origin pixels; `FILE#cam1` names one of several.

    InputError in one sentence where something is missing, contradicts itself or is not modelled.
    """
    file, name = _split(str(path))
    content, where = read_document(file), str(path)
    if name:
        if not isinstance(content.get(name), Mapping):
            raise InputError(f"{file}: no camera '{name}', found {', '.join(map(str, content))[:120] or 'nothing'}")
        content = content[name]
    reader, fields = _reader(content, where)
    try:
        camera, notes = reader(fields)
    except InputError as error:
        raise error if where in str(error) else InputError(f"{where}: {error}") from None
    return CameraFile(camera, (*notes, *_doubts(camera, where)))


def _split(text: str) -> tuple[Path, str]:
    """(file, name of the camera in it or nothing)."""
    whole = Path(text)
    if "#" in whole.name and not whole.exists():
        file, _, name = text.rpartition("#")
        return Path(file), name
    return whole, ""


def _reader(
    content: Mapping[str, Any], where: str
) -> tuple[Callable[[Fields], tuple[Camera, tuple[str, ...]]], Fields]:
    """The reader of this content, or of the one camera within it."""
    inside = {str(name): part for name, part in content.items() if isinstance(part, Mapping)}
    for part in (content, *(inside.values() if _count(inside, where) == 1 else ())):
        fields = Fields(part, where)
        for is_one, reader in _KINDS:
            if is_one(fields):
                return reader, fields
    cameras = [name for name, part in inside.items() if _is_camera(Fields(part, where))]
    if cameras:
        raise InputError(f"{where}: holds the cameras {', '.join(cameras)}; name one, as in {where}#{cameras[0]}")
    raise InputError(f"{where}: no camera in it, found {', '.join(map(str, content))[:120] or 'nothing'}; {_EXPECTED}")


def _count(inside: Mapping[str, Mapping[str, Any]], where: str) -> int:
    return sum(_is_camera(Fields(part, where)) for part in inside.values())


def _is_camera(fields: Fields) -> bool:
    return any(is_one(fields) for is_one, _ in _KINDS)


def _doubts(camera: Camera, where: str) -> tuple[str, ...]:
    """What looks odd about a camera; InputError where it cannot be meant."""
    size = camera.width, camera.height
    for name, centre, extent in zip(("cx", "cy"), (camera.cx, camera.cy), size, strict=True):
        if not -_OUTSIDE * extent <= centre <= (1.0 + _OUTSIDE) * extent:
            raise InputError(
                f"{where}: {name} {centre:g} px lies far outside the image of {size[0]} x {size[1]} px; are width and "
                "height those of the calibrated image?"
            )
    reach = lens_reach(camera)
    if reach is None:
        return ()
    if reach.share < _LEAST_SEEN:
        raise InputError(
            f"{where}: the lens folds {reach.radius_px:.0f} px from the principal point, so no ray leads to "
            f"{100.0 * (1.0 - reach.share):.0f} % of the image; calibrate with fewer coefficients or more views"
        )
    return (
        f"the lens folds {reach.radius_px:.0f} px from the principal point; {100.0 * (1.0 - reach.share):.1f} % of the "
        "image, beyond it, is left without rays",
    )
