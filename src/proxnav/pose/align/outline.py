"""The lines that a pose puts into the image: visible points on silhouettes, creases and borders of parts."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from proxnav.geometry.types import Rotation3x3, Vector3
from proxnav.pose.align.kernels.outline import sample_edges
from proxnav.pose.align.target_crop import TargetCrop
from proxnav.pose.align.wireframe import CREASE_RAD, wireframe
from proxnav.targets import Target
from proxnav.targets.keypoints.visibility import first_faces

_SIDE_PX = 1.5
"""How far on either side of a line what lies there is compared."""
_MOST = 8000
_ENOUGH = 1200
"""Points, hidden ones among them, beyond which every second or third is left out."""


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """Points and the normals of their lines in the image."""

    points_m: Float[np.ndarray, "n 3"]
    """Target axes."""
    normals: Float[np.ndarray, "n 2"]
    """Unit vectors in the image."""


def outline(target: Target, R: Rotation3x3, t: Vector3, crop: TargetCrop, spacing_px: float) -> Outline:
    """Points every `spacing_px` along the visible lines of the target at the pose (R, t) [m] of T_cam_target.

    A line is visible where two different things meet in the image.
    """
    wire = wireframe(target)
    eye = -R.T @ t
    X, N = np.empty((_MOST, 3)), np.empty((_MOST, 2))
    size = crop.camera
    edges = (wire.a_m, wire.b_m, wire.normal_1, wire.normal_2, wire.sharp)
    n = sample_edges(*edges, R, t, eye, crop.lens, size.width, size.height, spacing_px, X, N)
    thin = 1 + n // _ENOUGH
    X, N = X[:n:thin].copy(), N[:n:thin].copy()
    if n == 0:
        return Outline(X, N)
    kept = _is_seen(target, wire.face_normals, X, N, R, t, eye, (size.fx, size.fy))
    return Outline(X[kept], N[kept])


def _is_seen(
    target: Target,
    face_normals: Float[np.ndarray, "n_faces 3"],
    X: Float[np.ndarray, "n 3"],
    N: Float[np.ndarray, "n 2"],
    R: Rotation3x3,
    t: Vector3,
    eye: Vector3,
    focal_px: tuple[float, float],
) -> Bool[np.ndarray, "n"]:
    """Whether nothing lies before a point, and its two sides show different parts, depths, slopes or the sky."""
    n, tolerance = len(X), 0.01 * target.size_m
    p = X @ R.T + t
    side = np.zeros_like(p)
    side[:, :2] = _SIDE_PX * N * p[:, 2:] / focal_px
    origins = np.concatenate([X, np.broadcast_to(eye, (2 * n, 3))])
    rays = np.concatenate([eye - X, (p + side) @ R, (p - side) @ R])
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    origins[:n] += tolerance * rays[:n]
    distance, face = first_faces(target, origins, rays)
    free = ~(distance[:n] < np.linalg.norm(eye - X, axis=1) - tolerance)
    d1, d2, f1, f2 = distance[n : 2 * n], distance[2 * n :], face[n : 2 * n], face[2 * n :]
    both = (f1 >= 0) & (f2 >= 0)
    with np.errstate(invalid="ignore"):
        apart = np.abs(d1 - d2) > 6.0 * tolerance
    bent = np.einsum("ij,ij->i", face_normals[f1], face_normals[f2]) < np.cos(CREASE_RAD)
    unlike = apart | bent | (target.face_part[f1] != target.face_part[f2])
    return free & (((f1 >= 0) != (f2 >= 0)) | (both & unlike))
