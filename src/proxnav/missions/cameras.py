"""The camera of a mission: its numbers in the mission itself, or a calibration file beside it."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.calibration import EXACT, CalibrationSigma
from proxnav.missions.table import from_table, to_table

_FILE, _SIGMA = "file", "calibration_sigma"


def mission_camera(table: dict[str, Any], where: str, folder: Path) -> Camera:
    """The camera of a table [camera]; a `file` is looked for from `folder` on and stands for all numbers."""
    numbers = dict(table)
    sigma = from_table(CalibrationSigma, numbers.pop(_SIGMA, {}), f"{where}: {_SIGMA}")
    file = numbers.pop(_FILE, None)
    if file is None:
        return from_table(Camera, numbers, where, known={_SIGMA: sigma})
    if numbers or not isinstance(file, str):
        raise InputError(f"{where}: {_FILE} names a calibration file and stands alone, found also {', '.join(numbers)}")
    camera = Camera.read(folder / file)
    return camera if sigma == EXACT else replace(camera, calibration_sigma=sigma)


def camera_table(camera: Camera) -> dict[str, Any]:
    """The table that `mission_camera` reads back, without what is usual."""
    usual = {"projection"} if camera.projection == "pinhole" else set[str]()
    usual |= {_SIGMA} if camera.calibration_sigma.is_exact else set()
    return {key: value for key, value in to_table(camera).items() if key not in usual}
