"""Values of a calibration file by any of the names that their makers give them."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry.calibration import EXACT, CalibrationSigma
from proxnav.geometry.camera import Projection
from proxnav.storage.numbers import finite_numbers

WIDTHS = ("image_width", "width", "w")
HEIGHTS = ("image_height", "height", "h")
SIZES = ("image_size", "imagesize", "img_size", "imsize", "size", "resolution")
"""Width, then height."""
SHAPES = ("image_shape", "img_shape", "imageshape", "shape")
"""Rows, then columns, as NumPy has them."""
_FISHEYES = ("fisheye", "equidistant", "kannala_brandt", "kannala_brandt4", "opencv_fisheye")
_PINHOLES = ("plumb_bob", "rational_polynomial", "radtan", "brown_conrady", "pinhole", "opencv", "none", "")
_MOST_PX = 1_000_000


@dataclass(frozen=True, slots=True)
class Fields:
    """One camera's part of a file."""

    content: Mapping[str, Any]
    where: str
    """The file, for messages."""

    @property
    def names(self) -> set[str]:
        """Names in small letters."""
        return {str(name).lower() for name in self.content}

    def find(self, *names: str) -> Any:
        """The value under one of these names in capitals or small letters; None where there is none."""
        found = {str(key): value for key, value in self.content.items() if str(key).lower() in names}
        if len({repr(_bare(value)) for value in found.values()}) > 1:
            raise InputError(f"{self.where}: {' and '.join(found)} contradict each other; leave the right one")
        return next(iter(found.values()), None)

    def numbers(self, count: int | None, *names: str) -> Float[np.ndarray, "n"] | None:
        """Numbers under one of these names, row by row; None where there is none or it is empty."""
        value = _bare(self.find(*names))
        if value is None or (not isinstance(value, int | float | str) and np.size(value) == 0):
            return None
        return finite_numbers(value, count, f"{self.where}: {names[0]}")

    def number(self, *names: str) -> float | None:
        """One number."""
        found = self.numbers(1, *names)
        return None if found is None else float(found[0])

    def size(self, remedy: str) -> tuple[int, int]:
        """(width, height) [px]; InputError with `remedy` where the file has none."""
        width, height = self.number(*WIDTHS), self.number(*HEIGHTS)
        both, shape = self.numbers(2, *SIZES), self.numbers(None, *SHAPES)
        ways = [pair for pair in (
            None if width is None or height is None else (width, height),
            None if both is None else (both[0], both[1]),
            None if shape is None or len(shape) < 2 else (shape[1], shape[0]),
        ) if pair is not None]  # fmt: skip
        if not ways:
            raise InputError(f"{self.where}: the size of the image is missing; {remedy}")
        if len(set(ways)) > 1:
            raise InputError(f"{self.where}: {ways[0]} and {ways[1]} px contradict each other as the size of the image")
        return whole(ways[0][0], self.where), whole(ways[0][1], self.where)

    def projection(self) -> Projection:
        """Which lens the coefficients belong to; a pinhole's where nothing is said."""
        said = self.find("distortion_model", "projection", "camera_model", "model")
        word = "" if said is None else str(said).lower().removeprefix("cv2.").removeprefix("cv::")
        if word not in (*_FISHEYES, *_PINHOLES):
            raise InputError(
                f"{self.where}: lens model '{said}' is not read; {', '.join(_PINHOLES[:3])} and {_FISHEYES[1]} are"
            )
        flagged = str(_bare(self.find("fisheye_model", "fisheye"))).lower() in ("1", "1.0", "true")
        if flagged and word in _PINHOLES[:-2]:
            raise InputError(f"{self.where}: a fisheye by one key and {word} by another; leave the right one")
        return "fisheye" if flagged or word in _FISHEYES else "pinhole"

    def calibration_sigma(self) -> CalibrationSigma:
        """What the file says about its own errors; zeros where it says nothing."""
        said = self.find("calibration_sigma")
        if said is None:
            return EXACT
        if not isinstance(said, Mapping) or not set(said) <= {"focal", "principal_px"}:
            raise InputError(f"{self.where}: calibration_sigma needs focal and principal_px, found {ascii(said)[:60]}")
        own = Fields(said, f"{self.where}: calibration_sigma")
        return CalibrationSigma(own.number("focal") or 0.0, own.number("principal_px") or 0.0)


def whole(value: float, where: str) -> int:
    """A number of pixels."""
    if value != int(value) or not 0 < value <= _MOST_PX:
        raise InputError(f"{where}: an image of {value:g} px is none")
    return int(value)


def upright(K: Float[np.ndarray, "3 3"], where: str) -> Float[np.ndarray, "3 3"]:
    """A matrix [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]; InputError for a skew or another form."""
    if K[1, 0] != 0.0 or not np.array_equal(K[2], (0.0, 0.0, 1.0)):
        raise InputError(
            f"{where}: the camera matrix must be [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], found {K.tolist()}"
        )
    check_skew(float(K[0, 1]), float(K[0, 0]), where)
    return K


def check_skew(skew: float, fx: float, where: str) -> None:
    """InputError for pixels that are not rectangular."""
    if abs(skew) > 1e-6 * abs(fx):
        raise InputError(f"{where}: a skew of {skew:g} px is not modelled; calibrate without skew")


def _bare(value: Any) -> Any:
    """Numbers of a matrix that is written with its rows and columns; anything else as it is."""
    if isinstance(value, Mapping) and {"rows", "cols", "data"} <= set(value):
        return value["data"]
    return value.tolist() if isinstance(value, np.ndarray) else value
