"""fx, fy, cx, cy, width and height by name, as papers, BOP and many tools write them."""

from proxnav.errors import InputError
from proxnav.geometry.camera import Camera
from proxnav.geometry.camera_files.fields import Fields
from proxnav.geometry.camera_files.opencv_matrices import DISTORTION
from proxnav.geometry.camera_files.pixel_origin import guessed, stated, to_corner

FX, FY, FOCAL = ("fx", "fl_x"), ("fy", "fl_y"), ("f", "focal", "focal_px")
_NAMED = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")


def is_one(fields: Fields) -> bool:
    """Whether these are the fields of such a file."""
    return bool(fields.names & {*FX, *FOCAL})


def read_plain(fields: Fields) -> tuple[Camera, tuple[str, ...]]:
    """(camera, notes)."""
    where, both = fields.where, fields.number(*FOCAL)
    fx, fy = fields.number(*FX) or both, fields.number(*FY) or both
    cx, cy = fields.number("cx"), fields.number("cy")
    if fx is None or fy is None or cx is None or cy is None:
        raise InputError(f"{where}: fx, fy, cx and cy are needed [px], found {', '.join(sorted(fields.names))[:120]}")
    width, height = fields.size("add width and height")
    if max(fx, fy) < 1.0:
        raise InputError(f"{where}: fx {fx:g} and fy {fy:g} are no pixels; give the focal length in pixels")
    origin, assumed = stated(fields), ()
    if origin is None:
        origin, assumed = guessed(cx, cy, width, height, where)
    (cx, cy), notes = to_corner(cx, cy, origin)
    projection, sigma = fields.projection(), fields.calibration_sigma()
    k = _coefficients(fields, projection == "fisheye")
    return Camera(width, height, fx, fy, cx, cy, k, projection, sigma), (*assumed, *notes)


def _coefficients(fields: Fields, fisheye: bool) -> tuple[float, ...]:
    """Distortion as one list, or by the names of its coefficients."""
    listed, named = fields.numbers(None, *DISTORTION), fields.names & set(_NAMED)
    if listed is not None and named:
        raise InputError(f"{fields.where}: distortion both as a list and as {', '.join(sorted(named))}; leave one")
    if listed is not None:
        return tuple(listed.tolist())
    names = ("k1", "k2", "k3", "k4") if fisheye else _NAMED
    return tuple(fields.number(name) or 0.0 for name in names)
