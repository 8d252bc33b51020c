"""What BOP files say of themselves: rotations that were rounded, and metres where millimetres are meant."""

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.datasets.formats.labels import LabelRecord
from proxnav.errors import InputError, InputNote
from proxnav.geometry import Camera
from proxnav.storage.files import read_json

MODELS = ("models_eval", "models", "models_cad", "models_reconst")
"""Folders of the objects' meshes, the toolkit's choice for scores first."""
_EXACT = 1e-5
_NEAREST_MM = 150.0
"""No camera of such a set is nearer to its object; numbers of metres taken as millimetres are."""
_FAR_FROM_ONE = 30.0


def say_rounding(largest: float, source: Path) -> None:
    """An `InputNote` where rotation matrices had to be made orthogonal."""
    if largest > _EXACT:
        said = f"rotation matrices are rounded, R R^T departs from 1 by up to {largest:.1g}"
        warnings.warn(f"{source}: {said}; the nearest rotations are taken", InputNote, stacklevel=2)


def check_millimetres(records: Sequence[LabelRecord], camera: Camera | None, folder: Path) -> None:
    """InputError where positions are metres: all of them would be nearer than 15 cm, or the object, whose diameter the
    models tell, would be a thousand times as large in the image as it is labelled.
    """
    poses = [r.T_cam_target for r in records if r.T_cam_target is not None]
    if not poses:
        return
    range_mm = 1e3 * float(np.median([np.linalg.norm(T.t_m) for T in poses]))
    if range_mm < _NEAREST_MM:
        raise InputError(
            f"{folder}: positions {range_mm:.4g} mm from the camera look like metres; BOP's cam_t_m2c is in "
            "millimetres, multiply by 1000"
        )
    size = _size_ratio(records, camera, diameter_m(folder))
    if np.isfinite(size) and not 1.0 / _FAR_FROM_ONE < size < _FAR_FROM_ONE:
        raise InputError(
            f"{folder}: the object of models_info.json would be {size:.3g} times as large in the images as it is "
            "labelled; positions and models must both be in millimetres"
        )


def diameter_m(folder: Path) -> float:
    """Largest diameter in the models_info.json of a set [m]; NaN where there is none."""
    found = models_info(folder)
    try:
        known = [float(entry["diameter"]) for entry in found.values()] if isinstance(found, dict) else []
    except (KeyError, TypeError, ValueError):
        return float("nan")
    return max(known, default=float("nan")) / 1000.0


def models_info(folder: Path) -> Any:
    """Content of the models_info.json of a set, its split or its scene; {} where there is none."""
    path = models_folder(folder)
    return {} if path is None else read_json(path / "models_info.json", "BOP models")


def models_folder(folder: Path) -> Path | None:
    """The folder of models of a set, or of the set that a split or scene belongs to."""
    places = (folder.resolve(), *folder.resolve().parents[:2])
    return next((p / m for p in places for m in MODELS if (p / m / "models_info.json").is_file()), None)


def _size_ratio(records: Sequence[LabelRecord], camera: Camera | None, diameter: float) -> float:
    """Size in the image that diameter and range give, over that of the boxes, in the median image; NaN if unknown."""
    if camera is None or not np.isfinite(diameter):
        return float("nan")
    seen = [(r.T_cam_target, r.box_xyxy) for r in records if r.T_cam_target is not None and r.box_xyxy is not None]
    ratios = [
        diameter * camera.fx / max(float(np.linalg.norm(T.t_m)), 1e-12) / float(np.linalg.norm(box[2:] - box[:2]))
        for T, box in seen
    ]
    return float(np.median(ratios)) if ratios else float("nan")
