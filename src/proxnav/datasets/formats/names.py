"""Names from other people's files: refused before they can lead anywhere, in one sentence."""

from pathlib import PurePosixPath, PureWindowsPath

from proxnav.errors import InputError

_FORMULA = ("=", "+", "-", "@", "\t", "\r")
_LONGEST = 255


def checked_name(name: object, where: str) -> str:
    """`name` if it is a relative path that stays below its folder and that spreadsheets do not compute."""
    if not isinstance(name, str) or not name.strip():
        raise InputError(f"{where}: expected a file name, found {str(name)[:60]!r}")
    shown = ascii(name[:60])
    if len(name) > _LONGEST or not name.isprintable():
        raise InputError(f"{where}: file name {shown} holds control characters or more than {_LONGEST} characters")
    posix, windows = PurePosixPath(name), PureWindowsPath(name)
    if posix.is_absolute() or windows.anchor or ".." in windows.parts or ".." in posix.parts:
        raise InputError(f"{where}: file name {shown} leads out of the data set's folder; refused")
    if name.startswith(_FORMULA):
        raise InputError(f"{where}: file name {shown} is a formula to spreadsheets; rename the image")
    return name


def is_name(text: str) -> bool:
    """Whether `text` looks like an image's file name and not like a number."""
    return PurePosixPath(text).suffix.lower() in (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp")
