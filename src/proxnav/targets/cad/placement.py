"""From a file's axes, origin and unit to the target frame."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry import Pose
from proxnav.geometry.quaternion import from_matrix, multiply
from proxnav.geometry.types import Points
from proxnav.targets.cad.axes import R_target_file
from proxnav.targets.cad.file_frames import FILE_FRAME, FramePlace, triple
from proxnav.targets.cad.mesh_file import FileMesh

UNITS_M = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
PLAUSIBLE_M = (0.05, 500.0)
"""A spacecraft's largest extent: from a sensor dummy to a station."""


@dataclass(frozen=True, slots=True, eq=False)
class Placement:
    """How file coordinates become target coordinates: p_target = scale R (p_file - origin)."""

    scale_m: float
    """Metres per file unit."""
    R: Float[np.ndarray, "3 3"]
    """R_target_file."""
    origin: Float[np.ndarray, "3"]
    """The target frame's origin, in the file's coordinates and unit."""

    def points_m(self, points: Points) -> Points:
        """Points from file coordinates to the target frame [m]."""
        return (points - self.origin) @ self.R.T * self.scale_m

    def frame(self, name: str, place: FramePlace) -> Pose:
        """T_target_NAME of a frame that is given in the file's coordinates."""
        q = multiply(from_matrix(self.R), np.array(place.q_wxyz))
        return Pose.from_wxyz("target", name, q, self.points_m(np.array([place.r]))[0])

    def file_frame(self) -> Pose:
        """T_target_file: the file's own origin and axes in the target frame."""
        return self.frame(FILE_FRAME, FramePlace((0.0, 0.0, 0.0)))


def placement(
    path: Path,
    mesh: FileMesh,
    unit_m: float | None,
    length_m: float | None,
    up: str | None,
    forward: str | None,
    origin: str,
) -> Placement:
    """The file's own frame in metres, unless other axes (`up` or `forward`) or another origin are asked for.

    `origin` is `file`, `box` (the middle of the bounding box), or X,Y,Z in the file's coordinates and unit.
    """
    low, high = mesh.box()
    scale = _scale(path, float((high - low).max()), mesh.unit_m, unit_m, length_m)
    R = np.eye(3) if up is None and forward is None else R_target_file(up or mesh.up, forward or mesh.forward)
    places = {"file": np.zeros(3), "box": (low + high) / 2}
    at = places[origin] if origin in places else np.array(triple("--origin", origin))
    return Placement(scale, R, at)


def unit_in_metres(unit: str | None) -> float | None:
    """Metres per unit of a file, from the unit's name or a number; None for None."""
    if unit is None or unit in UNITS_M:
        return None if unit is None else UNITS_M[unit]
    try:
        return float(unit)
    except ValueError:
        raise InputError(f"--unit {unit}: expected {', '.join(UNITS_M)} or metres per unit as a number") from None


def _scale(path: Path, extent: float, declared_m: float | None, unit_m: float | None, length_m: float | None) -> float:
    """Metres per file unit."""
    if unit_m is not None and length_m is not None:
        raise InputError(f"{path}: give the unit or the true length, not both")
    for what, value in (("unit", unit_m), ("length", length_m)):
        if value is not None and not 1e-9 < value < 1e9:
            raise InputError(f"{path}: {what} {value} m is not a positive length")
    if not extent > 0:
        raise InputError(f"{path}: all its vertices lie in one point")
    if declared_m is not None and unit_m is not None and not abs(unit_m / declared_m - 1.0) < 1e-6:
        raise InputError(
            f"{path}: declares a unit of {declared_m:g} m, --unit says {unit_m:g} m; leave --unit out, or give the "
            "true length with --length-m where the file is wrong"
        )
    scale = length_m / extent if length_m is not None else (unit_m or declared_m or 1.0)
    if not PLAUSIBLE_M[0] <= extent * scale <= PLAUSIBLE_M[1]:
        guesses = ", ".join(f"{u}: {extent * f:.3g} m" for u, f in UNITS_M.items())
        raise InputError(
            f"{path}: its largest extent of {extent:.4g} units would be {extent * scale:.4g} m; say what the unit is "
            f"({guesses}) or how long the spacecraft is"
        )
    return scale
