"""A Target from a CAD or graphics file: unit, axes, parts, and keypoints."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry.types import Points
from proxnav.targets.assembly import assemble
from proxnav.targets.cad.axes import R_target_file
from proxnav.targets.cad.mesh_file import FilePart, read_parts
from proxnav.targets.keypoints.choice import suggest_keypoints
from proxnav.targets.keypoints.point_files import Loaded
from proxnav.targets.keypoints.spread import farthest_points
from proxnav.targets.solids import Piece
from proxnav.targets.target import Target

UNITS_M = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
PLAUSIBLE_M = (0.05, 500.0)
"""A spacecraft's largest extent: from a sensor dummy to a station."""
_DEFAULT_AXES = {".glb": ("y", "z"), ".gltf": ("y", "z"), ".obj": ("y", "z"), ".stl": ("z", "x"), ".ply": ("z", "x")}
N_KEYPOINTS = 24
N_SUBSET = 6


def from_mesh(
    path: Path | str,
    unit_m: float | None = None,
    up: str | None = None,
    forward: str | None = None,
    name: str | None = None,
    length_m: float | None = None,
    without: Sequence[str] = (),
    keypoints: Loaded | None = None,
    licence: str = "unknown",
) -> Target:
    """The spacecraft in a mesh file, centred in its bounding box, axes turned to forward, right, down.

    One of `unit_m` (metres per file unit) and `length_m` (true length of the largest extent) gives the scale; with
    neither the file's unit is taken as metres, and refused when that makes no spacecraft. `up` and `forward` are the
    file's axes (glTF and OBJ: up y, forward z; STL and PLY: up z, forward x). `without` drops parts by name.
    """
    path = Path(path)
    parts = _kept(path, read_parts(path), without)
    default_up, default_forward = _DEFAULT_AXES[path.suffix.lower()]
    R = R_target_file(up or default_up, forward or default_forward)
    corners = np.concatenate([part.vertices[np.unique(part.faces)] for part in parts])
    low, high = corners.min(axis=0), corners.max(axis=0)
    scale = _scale(path, float((high - low).max()), unit_m, length_m)
    pieces = [Piece(part.name, (part.vertices - (low + high) / 2) @ R.T * scale, part.faces) for part in parts]
    finish = {part.name: part.material for part in parts}
    source = f"{path.name}, 1 unit = {scale:.6g} m"
    target = assemble(name or path.stem, pieces, finish, {}, {}, licence, source)
    points, names = suggest_keypoints(target, N_KEYPOINTS) if keypoints is None else keypoints
    return with_keypoints(target, points, names)


def unit_in_metres(unit: str | None) -> float | None:
    """Metres per unit of a file, from the unit's name or a number; None for None."""
    if unit is None or unit in UNITS_M:
        return None if unit is None else UNITS_M[unit]
    try:
        return float(unit)
    except ValueError:
        raise InputError(f"--unit {unit}: expected {', '.join(UNITS_M)} or metres per unit as a number") from None


def file_extents(path: Path, without: Sequence[str] = ()) -> tuple[float, float, float]:
    """Extents along the file's axes x, y, z in its own unit."""
    corners = np.concatenate([part.vertices[np.unique(part.faces)] for part in _kept(path, read_parts(path), without)])
    x, y, z = np.ptp(corners, axis=0).tolist()
    return x, y, z


def with_keypoints(target: Target, points_m: Points, names: Sequence[str]) -> Target:
    """The target with these keypoints and, from six on, a well spread subset `six`."""
    first = int(np.argmax(np.linalg.norm(points_m - points_m.mean(axis=0), axis=1)))
    six = tuple(farthest_points(points_m, N_SUBSET, first)) if len(points_m) >= N_SUBSET else ()
    subsets = {"six": six} if six else {}
    return replace(target, keypoints_m=points_m, keypoint_names=tuple(names), subsets=subsets)


def isolated_parts(target: Target, gap: float = 0.25) -> list[str]:
    """Parts whose bounding box is no neighbour, even through others, of the largest part's: `gap` is in its diagonals.

    Files often hold leftovers far off the spacecraft; name them in `without`.
    """
    corners = target.vertices_m[target.faces]
    boxes = [corners[target.face_part == i].reshape(-1, 3) for i in range(len(target.part_names))]
    low, high = np.array([b.min(axis=0) for b in boxes]), np.array([b.max(axis=0) for b in boxes])
    main = int(np.argmax(np.linalg.norm(high - low, axis=1)))
    group, reach = {main}, gap * float(np.linalg.norm(high[main] - low[main]))
    while True:
        lo, hi = low[list(group)].min(axis=0), high[list(group)].max(axis=0)
        apart = np.linalg.norm(np.maximum(0.0, np.maximum(low - hi, lo - high)), axis=1)
        grown = group | set(np.flatnonzero(apart < reach).tolist())
        if grown == group:
            return [target.part_names[i] for i in range(len(boxes)) if i not in group]
        group = grown


def _kept(path: Path, parts: list[FilePart], without: Sequence[str]) -> list[FilePart]:
    names = [part.name for part in parts]
    unknown = [name for name in without if name not in names]
    if unknown:
        raise InputError(f"{path}: no part '{unknown[0]}' to leave out; it has {', '.join(names[:20])}")
    kept = [part for part in parts if part.name not in without]
    if not kept:
        raise InputError(f"{path}: every part is left out")
    return kept


def _scale(path: Path, extent: float, unit_m: float | None, length_m: float | None) -> float:
    """Metres per file unit."""
    if unit_m is not None and length_m is not None:
        raise InputError(f"{path}: give the unit or the true length, not both")
    for what, value in (("unit", unit_m), ("length", length_m)):
        if value is not None and not 1e-9 < value < 1e9:
            raise InputError(f"{path}: {what} {value} m is not a positive length")
    if not extent > 0:
        raise InputError(f"{path}: all its vertices lie in one point")
    scale = length_m / extent if length_m is not None else (1.0 if unit_m is None else unit_m)
    if not PLAUSIBLE_M[0] <= extent * scale <= PLAUSIBLE_M[1]:
        guesses = ", ".join(f"{u}: {extent * f:.3g} m" for u, f in UNITS_M.items())
        raise InputError(
            f"{path}: its largest extent of {extent:.4g} units would be {extent * scale:.4g} m; say what the unit is "
            f"({guesses}) or how long the spacecraft is"
        )
    return scale
