"""One camera of a Kalibr camchain: intrinsics (fu, fv, pu, pv), pixel centres whole."""

from proxnav.errors import InputError
from proxnav.geometry.camera import Camera
from proxnav.geometry.camera_files.fields import Fields
from proxnav.geometry.camera_files.pixel_origin import CENTRE, to_corner

_LENSES = ("radtan", "equidistant", "none")


def is_one(fields: Fields) -> bool:
    """Whether these are the fields of such a file."""
    return {"camera_model", "intrinsics"} <= fields.names


def read_kalibr(fields: Fields) -> tuple[Camera, tuple[str, ...]]:
    """(camera, notes)."""
    model, lens = (str(fields.find(name) or "none").lower() for name in ("camera_model", "distortion_model"))
    if model != "pinhole" or lens not in _LENSES:
        raise InputError(
            f"{fields.where}: {model}-{lens} is not read; calibrate as pinhole-radtan or pinhole-equidistant"
        )
    found = fields.numbers(4, "intrinsics")
    if found is None:
        raise InputError(f"{fields.where}: intrinsics are empty")
    fx, fy, pu, pv = found.tolist()
    width, height = fields.size("add resolution: [width, height]")
    k = fields.numbers(None if lens == "none" else 4, "distortion_coeffs")
    fisheye = lens == "equidistant"
    coefficients = (0.0,) * (4 if fisheye else 5) if k is None or lens == "none" else tuple(k.tolist())
    (cx, cy), notes = to_corner(pu, pv, CENTRE)
    sigma = fields.calibration_sigma()
    return Camera(width, height, fx, fy, cx, cy, coefficients, "fisheye" if fisheye else "pinhole", sigma), notes
