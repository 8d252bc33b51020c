"""Where the first pixel lies for whoever wrote a file: principal points are moved to corner origin and it is said."""

from proxnav.errors import InputError
from proxnav.geometry.camera_files.fields import Fields

CENTRE, CORNER, MATLAB = "centre", "corner", "matlab"
_SHIFT = {CENTRE: 0.5, CORNER: 0.0, MATLAB: -0.5}
_WORDS = {
    CENTRE: "principal point converted from pixel centres ({0:g}, {1:g} -> {2:g}, {3:g} px)",
    MATLAB: "principal point converted from MATLAB's pixel centres, counted from 1 ({0:g}, {1:g} -> {2:g}, {3:g} px)",
}


def to_corner(cx: float, cy: float, origin: str) -> tuple[tuple[float, float], tuple[str, ...]]:
    """((cx, cy) in corner origin, notes of what was done)."""
    shift = _SHIFT[origin]
    moved = cx + shift, cy + shift
    return moved, (_WORDS[origin].format(cx, cy, *moved),) if shift else ()


def stated(fields: Fields) -> str | None:
    """What the file itself says with `pixel_origin`."""
    said = fields.find("pixel_origin")
    if said not in (None, CENTRE, "center", CORNER):
        raise InputError(f"{fields.where}: pixel_origin must be corner or centre, found {ascii(said)[:40]}")
    return CENTRE if said == "center" else said


def guessed(cx: float, cy: float, width: int, height: int, where: str) -> tuple[str, tuple[str, ...]]:
    """(origin, notes) of bare numbers: a middle of (width - 1) / 2 is of pixel centres, anything else of corners."""
    centred = cx == 0.5 * (width - 1) or cy == 0.5 * (height - 1)
    cornered = cx == 0.5 * width or cy == 0.5 * height
    if centred and cornered:
        raise InputError(
            f"{where}: cx {cx:g} and cy {cy:g} are the middle of {width} x {height} px by two different origins of "
            "pixels; say which with pixel_origin = corner or centre"
        )
    if centred:
        return CENTRE, ()
    if cornered:
        return CORNER, ()
    return CORNER, (
        f"principal point ({cx:g}, {cy:g}) taken as counted from the corner of the first pixel; "
        "if it comes from OpenCV, add pixel_origin: centre",
    )
