"""The object whose surface some scores look at: its points, its diameter and the turns that leave it as it is."""

from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from proxnav.datasets.formats.bop_units import models_folder, models_info
from proxnav.errors import InputError
from proxnav.geometry import Pose
from proxnav.geometry.arrays import frozen
from proxnav.geometry.diameter import diameter
from proxnav.geometry.types import Points
from proxnav.storage.numbers import finite_numbers

_MM = 1000.0
_STEP = 0.01
"""Largest arc by which a point of the surface moves from one turn of a continuous symmetry to the next, in parts of
the diameter: that of the BOP challenge.
"""
_LARGEST_PLY = 2**28


@dataclass(frozen=True, slots=True, eq=False)
class ObjectModel:
    """Points of the surface in the target frame, and its symmetries."""

    points_m: Points
    diameter_m: float
    """Largest distance of two points."""
    symmetries: tuple[Pose, ...] = (Pose.identity("target", "target"),)
    """Turns that map the object onto itself, the identity among them."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "points_m", frozen(self.points_m, (None, 3), "points_m"))

    @staticmethod
    def of_points(points_m: Points) -> "ObjectModel":
        """An object without symmetries."""
        return ObjectModel(points_m, diameter(points_m))


def bop_model(folder: Path, object_id: int) -> ObjectModel | None:
    """The object of a BOP set, from models_eval/ where there is one; None where the set has no models."""
    models = models_folder(folder)
    path = None if models is None else models / f"obj_{object_id:06d}.ply"
    if path is None or not path.is_file():
        return None
    if path.stat().st_size > _LARGEST_PLY:
        raise InputError(f"{path}: larger than {_LARGEST_PLY // 2**20} MiB; use the smaller models_eval/")
    info = models_info(folder).get(str(object_id), {})
    try:
        points_m = _vertices(path) / _MM
        size_m = float(info["diameter"]) / _MM if "diameter" in info else diameter(points_m)
        return ObjectModel(points_m, size_m, symmetries(info))
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise InputError(f"{models}: not BOP models ({type(error).__name__}: {str(error)[:80]!a})") from None


def symmetries(info: Any) -> tuple[Pose, ...]:
    """Every symmetry of an entry of models_info.json: the discrete ones with every turn of the continuous ones."""
    given = [finite_numbers(M, 16, "symmetries_discrete") for M in info.get("symmetries_discrete", [])]
    discrete = [np.eye(4), *(M.reshape(4, 4) for M in given)]
    turns = [np.eye(4)]
    for one in info.get("symmetries_continuous", []):
        turns = [turn @ M for turn, M in product(_turns(one), turns)]
    return tuple(_pose(turn @ M) for M, turn in product(discrete, turns))


def _turns(entry: Any) -> list[Float[np.ndarray, "4 4"]]:
    """Turns about an axis through a point [mm]."""
    axis = finite_numbers(entry["axis"], 3, "axis of a symmetry")
    offset = finite_numbers(entry["offset"], 3, "offset of a symmetry")
    count = int(np.ceil(np.pi / _STEP))
    found = []
    for angle in 2.0 * np.pi * np.arange(count) / count:
        M = np.eye(4)
        M[:3, :3] = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix()
        M[:3, 3] = offset - M[:3, :3] @ offset
        found.append(M)
    return found


def _pose(M_mm: Float[np.ndarray, "4 4"]) -> Pose:
    return Pose.from_rounded_matrix("target", "target", M_mm[:3, :3], M_mm[:3, 3] / _MM)


def _vertices(path: Path) -> Points:
    import trimesh

    mesh: Any = trimesh.load(path, process=False, force="mesh")
    return np.asarray(mesh.vertices, dtype=np.float64)
