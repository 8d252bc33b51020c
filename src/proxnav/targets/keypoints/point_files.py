"""Keypoints from a file: MATLAB, JSON or csv."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.storage.mat_file import read_matrices
from proxnav.storage.tables import is_number, read_rows

MAX_BYTES = 16 * 2**20
MAX_POINTS = 10_000
_MAT_NAMES = ("tango3Dpoints", "corners", "keypoints_m", "points", "landmarks")
_UNITS_M = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}
_OTHER_UNITS = ("km", "um", "dm", "yd", "px")
_JSON_NAMES = ("keypoints_m", "points_m", "keypoints", "points", "landmarks")

Loaded = tuple[Float[np.ndarray, "n 3"], tuple[str, ...]]


def load_points(path: Path | str) -> Loaded:
    """Points [m] in the target frame and their names (p00, p01, ... where the file has none).

    Reads .mat (tango3Dpoints, 3 x n), .json (a target.json, a list of triples, or name -> triple) and .csv
    (x,y,z or name,x,y,z, header optional; x_mm, y_mm, z_mm and the like are read in their unit).
    """
    path = Path(path)
    readers = {".mat": _from_mat, ".json": _from_json, ".csv": _from_csv}
    if path.suffix.lower() not in readers:
        raise InputError(f"{path}: keypoints come from .mat, .json or .csv, found '{path.suffix}'")
    if not path.is_file() or path.stat().st_size > MAX_BYTES:
        raise InputError(f"{path}: no such keypoint file, or larger than {MAX_BYTES // 2**20} MiB")
    points, names = readers[path.suffix.lower()](path)
    return _checked(path, points, names)


def _checked(path: Path, points: Float[np.ndarray, "..."], names: list[str] | None) -> Loaded:
    points = np.atleast_1d(points)
    names = names or [f"p{i:02d}" for i in range(len(points))]
    if points.ndim != 2 or points.shape[1] != 3 or not 4 <= len(points) <= MAX_POINTS:
        raise InputError(f"{path}: found points of shape {points.shape}; a pose needs 4 to {MAX_POINTS} of x, y, z")
    if not np.isfinite(points).all():
        raise InputError(f"{path}: point {int(np.argmin(np.isfinite(points).all(axis=1)))} is not finite")
    if len(names) != len(points) or len(set(names)) != len(names):
        raise InputError(f"{path}: {len(points)} points but {len(set(names))} different names")
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if spread[1] < 1e-6 * max(float(spread[0]), 1e-300):
        raise InputError(f"{path}: all points lie on one line; a pose needs points in at least a plane")
    return points, tuple(names)


def _from_mat(path: Path) -> tuple[Float[np.ndarray, "..."], list[str] | None]:
    try:
        arrays = read_matrices(path.read_bytes())
    except ValueError as error:
        raise InputError(f"{path}: not a MATLAB file of level 5 ({error}); save with -v7") from None
    known = [name for name in _MAT_NAMES if name in arrays] or [k for k, v in arrays.items() if 3 in v.shape]
    if not known:
        raise InputError(f"{path}: no 3 x n variable such as tango3Dpoints, found {', '.join(arrays) or 'none'}")
    points = np.asarray(arrays[known[0]], dtype=np.float64)
    return (points.T if points.shape[0] == 3 else points), None


def _from_json(path: Path) -> tuple[Float[np.ndarray, "..."], list[str] | None]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError):
        raise InputError(f"{path}: not JSON") from None
    names = None
    if isinstance(content, dict):
        found = [name for name in _JSON_NAMES if name in content]
        names = content.get("keypoint_names") or content.get("names")
        names = names if isinstance(names, list) else None
        if found:
            content = content[found[0]]
        if isinstance(content, dict):
            names, content = list(content), list(content.values())
    return _array(path, content), None if names is None else [str(name) for name in names]


def _from_csv(path: Path) -> tuple[Float[np.ndarray, "..."], list[str] | None]:
    rows, unit_m = read_rows(path, MAX_BYTES), 1.0
    if not is_number(rows[0][-1]):
        unit_m, rows = _unit(path, rows[0]), rows[1:]
    width = {len(row) for row in rows}
    if width not in ({3}, {4}):
        raise InputError(f"{path}: expected rows x,y,z or name,x,y,z, found rows of {sorted(width) or 'nothing'} cells")
    named = width == {4}
    points = unit_m * _array(path, [row[-3:] for row in rows])
    return points, [row[0] for row in rows] if named else None


def _unit(path: Path, header: list[str]) -> float:
    """Metres of the unit that the last three columns name, as in x_mm or z [mm]; 1 where they name none."""
    words = [re.split(r"[^a-z]+", cell.strip().lower().rstrip("])"))[-1] for cell in header[-3:]]
    named = {word for word in words if word in _UNITS_M or word in _OTHER_UNITS}
    if not named:
        return 1.0
    if len(named) > 1 or not named <= set(_UNITS_M):
        raise InputError(f"{path}: the columns are in {', '.join(sorted(named))}; give all in m, mm, cm, in or ft")
    return _UNITS_M[named.pop()]


def _array(path: Path, content: Any) -> Float[np.ndarray, "..."]:
    try:
        points = np.array(content, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{path}: expected triples of numbers [m]") from None
    return points.T if points.ndim == 2 and points.shape[0] == 3 != points.shape[1] else points
