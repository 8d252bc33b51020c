"""`camera.json` as SPEED+ writes it: numbers only, focal length in metres, the matrix in pixels, corner origin.

Two keys of our own, both numbers and only where they say something: `fisheye` 1, and `calibrationSigma` (relative error
of the focal length, error of the principal point [px]).
"""

from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry.calibration import CalibrationSigma
from proxnav.geometry.camera import Camera
from proxnav.geometry.camera_files.fields import Fields
from proxnav.storage.files import read_json

_KEYS = ("Nu", "Nv", "cameraMatrix", "distCoeffs")
_LARGEST = 1e9  # px; arithmetic on larger numbers overflows
_PIXEL_PITCH_M = 5.86e-6  # of the SPEED+ camera; only the derived focal length in metres depends on it


def read_speed_json(path: Path) -> Camera:
    """The camera of a SPEED+ `camera.json`; InputError names the file and the key at fault."""
    content = read_json(path, "a SPEED+ camera.json")
    if not isinstance(content, dict):
        raise InputError(f"{path}: a camera.json holds one JSON object, found {type(content).__name__}")
    return _camera(content, str(path))


def is_one(fields: Fields) -> bool:
    """Whether these are the fields of such a file."""
    return bool(fields.names & {"nu", "nv"})


def read_speed(fields: Fields) -> tuple[Camera, tuple[str, ...]]:
    """(camera, notes)."""
    return _camera(dict(fields.content), fields.where), ()


def _camera(content: dict[str, Any], where: str) -> Camera:
    missing = [key for key in _KEYS if key not in content]
    if missing:
        raise InputError(
            f"{where}: keys {', '.join(missing)} are missing, found {', '.join(content) or 'none'}; "
            f"a SPEED+ camera.json needs {', '.join(_KEYS)}"
        )
    try:
        K, k, width, height = _numbers(content)
        fisheye, sigma = bool(int(content.get("fisheye", 0))), _sigma(content)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(
            f"{where}: cameraMatrix must be 3x3 numbers, distCoeffs 4, 5, 8, 12 or 14 numbers, "
            f"Nu and Nv integers ({error})"
        ) from None
    if K[0, 1] != 0.0 or K[1, 0] != 0.0 or not np.array_equal(K[2], (0.0, 0.0, 1.0)):
        raise InputError(f"{where}: cameraMatrix must be [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], found {K.tolist()}")
    (fx, _, cx), (_, fy, cy), _ = K.tolist()
    try:
        return Camera(
            width,
            height,
            fx,
            fy,
            cx,
            cy,
            tuple(k.tolist()),
            "fisheye" if fisheye else "pinhole",
            CalibrationSigma(*sigma),
        )
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _sigma(content: dict[str, Any]) -> tuple[float, float]:
    focal, principal_px = np.array(content.get("calibrationSigma", (0.0, 0.0)), dtype=np.float64).reshape(2).tolist()
    return focal, principal_px


def _numbers(content: dict[str, Any]) -> tuple[Float[np.ndarray, "3 3"], Float[np.ndarray, "n"], int, int]:
    """(matrix, distortion, width, height); ValueError or TypeError where they are none."""
    K = np.array(content["cameraMatrix"], dtype=np.float64).reshape(3, 3)
    k = np.array(content["distCoeffs"], dtype=np.float64)
    if k.ndim != 1:
        raise ValueError("distCoeffs is no list")
    if not (np.abs(K) <= _LARGEST).all() or not (np.abs(k) <= _LARGEST).all():
        raise ValueError(f"a number is not finite or beyond {_LARGEST:g}")
    return K, k, _whole(content["Nu"]), _whole(content["Nv"])


def speed_json(camera: Camera, pixel_pitch_m: float = _PIXEL_PITCH_M) -> dict[str, Any]:
    """A `Camera` as the content of a SPEED+ `camera.json`."""
    content: dict[str, Any] = {
        "Nu": camera.width,
        "Nv": camera.height,
        "ppx": pixel_pitch_m,
        "ppy": pixel_pitch_m,
        "fx": camera.fx * pixel_pitch_m,
        "fy": camera.fy * pixel_pitch_m,
        "ccx": camera.cx,
        "ccy": camera.cy,
        "cameraMatrix": camera.K.tolist(),
        "distCoeffs": list(camera.distortion),
    }
    sigma = camera.calibration_sigma
    if camera.projection == "fisheye":
        content["fisheye"] = 1
    return content if sigma.is_exact else content | {"calibrationSigma": [sigma.focal, sigma.principal_px]}


def _whole(value: Any) -> int:
    if int(value) != float(value):
        raise ValueError(f"{value} is not a whole number of pixels")
    return int(value)
