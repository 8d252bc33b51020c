"""Files that a mesh file refers to lie beside it, or it is refused."""

from pathlib import Path

from proxnav.errors import InputError


def check_inside(path: Path, uri: str) -> None:
    """InputError where `uri`, as written in the file `path`, leads out of its folder."""
    try:
        place = (path.parent / uri).resolve()
        place.exists()
    except (OSError, ValueError):  # too long, NUL, half a surrogate pair
        raise InputError(f"{path}: refers to {uri[:80]!r}, which no file can be called") from None
    if "://" in uri or not place.is_relative_to(path.parent.resolve()):
        raise InputError(f"{path}: refers to '{uri[:80]}' outside its folder; expected files beside it")
