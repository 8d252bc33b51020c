"""`camera.json` as SPEED+ writes it: numbers only, focal length in metres, the matrix in pixels."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.errors import InputError

_KEYS = ("Nu", "Nv", "cameraMatrix", "distCoeffs")
_MOST_BYTES = 2**20
_LARGEST = 1e9  # px; arithmetic on larger numbers overflows
_PIXEL_PITCH_M = 5.86e-6  # of the SPEED+ camera; only the derived focal length in metres depends on it


def read_speed_json(path: str | Path) -> dict[str, Any]:
    """Fields of `Camera` from a SPEED+ `camera.json`; InputError names the file and the key at fault."""
    content = _load(Path(path))
    missing = [key for key in _KEYS if key not in content]
    if missing:
        raise InputError(
            f"{path}: keys {', '.join(missing)} are missing, found {', '.join(content) or 'none'}; "
            f"a SPEED+ camera.json needs {', '.join(_KEYS)}"
        )
    try:
        K = np.array(content["cameraMatrix"], dtype=np.float64).reshape(3, 3)
        k = np.array(content["distCoeffs"], dtype=np.float64).reshape(5)
        width, height = _whole(content["Nu"]), _whole(content["Nv"])
        if not (np.abs(K) <= _LARGEST).all() or not (np.abs(k) <= _LARGEST).all():
            raise ValueError(f"a number is not finite or beyond {_LARGEST:g}")
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(
            f"{path}: cameraMatrix must be 3x3 numbers, distCoeffs 5 numbers, Nu and Nv integers ({error})"
        ) from None
    if K[0, 1] != 0.0 or K[1, 0] != 0.0 or not np.array_equal(K[2], (0.0, 0.0, 1.0)):
        raise InputError(f"{path}: cameraMatrix must be [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], found {K.tolist()}")
    fields = {"width": width, "height": height, "fx": K[0, 0], "fy": K[1, 1], "cx": K[0, 2], "cy": K[1, 2]}
    return {key: value if isinstance(value, int) else float(value) for key, value in fields.items()} | {
        "distortion": tuple(k.tolist())
    }


def speed_json(camera: Any, pixel_pitch_m: float = _PIXEL_PITCH_M) -> dict[str, Any]:
    """A `Camera` as the content of a SPEED+ `camera.json`."""
    return {
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


def _whole(value: Any) -> int:
    if int(value) != float(value):
        raise ValueError(f"{value} is not a whole number of pixels")
    return int(value)


def _load(path: Path) -> dict[str, Any]:
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise InputError(f"{path}: larger than {_MOST_BYTES // 2**20} MiB, which no camera.json is")
        content = json.loads(path.read_text(encoding="utf-8"))
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; give the camera.json of the data set") from None
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: not readable as JSON ({error})") from None
    if not isinstance(content, dict):
        raise InputError(f"{path}: a camera.json holds one JSON object, found {type(content).__name__}")
    return content
