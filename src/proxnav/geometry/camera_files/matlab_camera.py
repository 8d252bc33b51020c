"""MATLAB's cameraParameters or cameraIntrinsics as a structure: its pixels count from 1 at the first pixel's centre."""

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry.camera import Camera
from proxnav.geometry.camera_files.fields import Fields, check_skew, upright
from proxnav.geometry.camera_files.pixel_origin import MATLAB, to_corner

_OWN = {"intrinsicmatrix", "focallength", "principalpoint", "radialdistortion"}
_FISHEYE = {"mappingcoefficients", "stretchmatrix"}


def is_one(fields: Fields) -> bool:
    """Whether these are the fields of such a file."""
    return bool(fields.names & (_OWN | _FISHEYE))


def read_matlab(fields: Fields) -> tuple[Camera, tuple[str, ...]]:
    """(camera, notes)."""
    where = fields.where
    if fields.names & _FISHEYE:
        raise InputError(f"{where}: MATLAB's fisheyeIntrinsics are not read; calibrate with OpenCV's fisheye or Kalibr")
    fx, fy, cx, cy = _intrinsics(fields)
    shape = fields.numbers(2, "imagesize")
    if shape is None:
        raise InputError(f"{where}: ImageSize is empty; set it to [rows columns] of the image and save again")
    radial, tangential = fields.numbers(None, "radialdistortion"), fields.numbers(2, "tangentialdistortion")
    k = np.zeros(3) if radial is None else radial
    if len(k) not in (2, 3):
        raise InputError(f"{where}: RadialDistortion has 2 or 3 coefficients, found {len(k)}")
    p = np.zeros(2) if tangential is None else tangential
    (cx, cy), notes = to_corner(cx, cy, MATLAB)
    sigma, size = fields.calibration_sigma(), Fields({"shape": shape}, where).size("")
    return Camera(*size, fx, fy, cx, cy, (*k[:2].tolist(), *p.tolist(), *k[2:].tolist()), "pinhole", sigma), notes


def _intrinsics(fields: Fields) -> tuple[float, float, float, float]:
    """(fx, fy, cx, cy) from the matrix, FocalLength and PrincipalPoint, which must agree where both are there."""
    where, found = fields.where, []
    for name in ("intrinsicmatrix", "k"):
        matrix = fields.numbers(9, name)
        if matrix is not None:
            found.append(_of_matrix(matrix.reshape(3, 3), where))
    focal, centre = fields.numbers(2, "focallength"), fields.numbers(2, "principalpoint")
    if focal is not None and centre is not None:
        check_skew(fields.number("skew") or 0.0, float(focal[0]), where)
        found.append(np.concatenate([focal, centre]))
    if not found:
        raise InputError(f"{where}: neither IntrinsicMatrix nor FocalLength and PrincipalPoint; save toStruct(params)")
    if any(np.abs(one - found[0]).max() > 1e-6 * np.abs(found[0]).max() for one in found):
        raise InputError(f"{where}: IntrinsicMatrix, FocalLength and PrincipalPoint contradict each other")
    fx, fy, cx, cy = found[0].tolist()
    return fx, fy, cx, cy


def _of_matrix(M: Float[np.ndarray, "3 3"], where: str) -> Float[np.ndarray, "4"]:
    """fx, fy, cx, cy; IntrinsicMatrix is the transpose of K, which newer releases write."""
    K = upright(M.T if not M[:2, 2].any() else M, where)
    return np.array([K[0, 0], K[1, 1], K[0, 2], K[1, 2]])
