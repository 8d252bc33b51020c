"""3-D points of the target from pixels and poses of several images, where a set has these and not those."""

import warnings
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from proxnav.datasets.formats.labels import Labels
from proxnav.errors import InputNote
from proxnav.geometry import Camera
from proxnav.geometry.arrays import unit
from proxnav.geometry.types import Points

LEAST_IMAGES = 4
_LEAST_SPREAD = 1e-3
"""Smallest eigenvalue of a point's mean ray equations: below it the rays are parallel."""


def recovered(
    camera: Camera, R: Float[np.ndarray, "n 3 3"], t_m: Float[np.ndarray, "n 3"], pixels: Float[np.ndarray, "n k 2"]
) -> Points | None:
    """The points of the target that lie nearest to all rays of their pixels, target frame [m]; None where the images
    are fewer than four, or the rays of a point are too few or too parallel.
    """
    if len(pixels) < LEAST_IMAGES:
        return None
    rays = unit(camera.unproject(pixels)) @ R  # row vectors: R^T ray, target frame
    known = np.asarray(np.isfinite(rays).all(axis=2))
    rays = np.where(known[..., None], rays, 0.0)
    centres = -np.einsum("nji,nj->ni", R, t_m)
    across = np.eye(3) * known[..., None, None] - rays[..., :, None] * rays[..., None, :]
    A, b = across.sum(axis=0), np.einsum("nkij,nj->ki", across, centres)
    count = known.sum(axis=0)
    if count.min() < LEAST_IMAGES or (np.linalg.eigvalsh(A)[:, 0] < _LEAST_SPREAD * count).any():
        return None
    return np.linalg.solve(A, b[..., None])[..., 0]


def with_recovered_points(labels: Labels) -> Labels:
    """The labels with the target's points from their pixels where the source has none, said as an `InputNote`."""
    seen = [r for r in labels.records if r.T_cam_target is not None and r.keypoints_px is not None]
    if labels.keypoints_m is not None or labels.camera is None or not seen:
        return labels
    poses = [r.T_cam_target for r in seen if r.T_cam_target is not None]
    R, t_m = np.array([T.R for T in poses]), np.array([T.t_m for T in poses])
    points = recovered(labels.camera, R, t_m, np.array([r.keypoints_px for r in seen]))
    if points is None:
        return labels
    found = f"the {len(points)} points of the target are found from the pixels of {len(seen)} images"
    warnings.warn(f"{found}; --target gives exact ones", InputNote, stacklevel=2)
    return replace(labels, keypoints_m=points)
