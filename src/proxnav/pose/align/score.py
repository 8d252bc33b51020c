"""How well a pose explains an image: its outline on edges, its parts in one tone each, its distance from the prior."""

from typing import NamedTuple

import numpy as np

from proxnav.geometry import Pose
from proxnav.pose.align.kernels.edges import share_on_edges
from proxnav.pose.align.kernels.regions import unexplained_share
from proxnav.pose.align.outline import outline
from proxnav.pose.align.prior import Prior
from proxnav.pose.align.target_crop import TargetCrop
from proxnav.pose.align.wireframe import wireframe
from proxnav.targets import Target
from proxnav.targets.keypoints.visibility import first_faces

# Weights chosen on validation images (docs/alignment.md).
REGION_WEIGHT = 0.3
"""Weight of -log(unexplained share of the image) in the score; the share of the outline on edges weighs 1."""
PRIOR_WEIGHT, PRIOR_MOST = 0.001, 60.0
"""Weight of the squared Mahalanobis distance from the keypoint pose, and the most of it that counts: keypoint poses
have a tail."""
REGION_SIDE_PX = 80
"""Side of the square in which regions are compared."""
_MOST = 3.0
"""Residual in roots of counts above which a pixel says no more: shadow, texture."""


class Sampling(NamedTuple):
    """How finely an outline is compared with edges."""

    blur_px: float
    """Standard deviation by which the image is blurred."""
    spacing_px: float
    """Distance of the outline's points."""


def score(target: Target, T_cam_target: Pose, crop: TargetCrop, prior: Prior, sampling: Sampling) -> float:
    """Score of a pose, larger is better; it compares poses within one image."""
    lines = edge_share(target, T_cam_target, crop, sampling)
    regions = -np.log(max(region_misfit(target, T_cam_target, crop, REGION_SIDE_PX), 1e-3))
    far = min(prior.distance2(T_cam_target), PRIOR_MOST)
    return lines + REGION_WEIGHT * float(regions) - PRIOR_WEIGHT * far


def edge_share(target: Target, T_cam_target: Pose, crop: TargetCrop, sampling: Sampling) -> float:
    """Share in [0, 1] of the outline that lies on edges of the image; 0 for less than ten points."""
    R, t = T_cam_target.R, T_cam_target.t_m
    lines = outline(target, R, t, crop, sampling.spacing_px)
    if len(lines.points_m) < 10:
        return 0.0
    gx, gy = crop.gradients(sampling.blur_px)
    noise = 0.5 + 2.0 * crop.noise
    return share_on_edges(lines.points_m, lines.normals, R, t, crop.lens, gx, gy, noise)


def region_misfit(target: Target, T_cam_target: Pose, crop: TargetCrop, side: int) -> float:
    """Share in [0, 1] of the image's scatter that smoothly shaded parts before a plain sky leave unexplained."""
    counts, camera = crop.grid(side)
    rows, columns = np.indices(counts.shape) + 0.5
    rays = camera.unproject(np.stack([columns.ravel(), rows.ravel()], axis=1)) @ T_cam_target.R
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    eye = -T_cam_target.R.T @ T_cam_target.t_m
    _, face = first_faces(target, np.broadcast_to(eye, rays.shape), np.nan_to_num(rays, nan=0.0))
    part = np.where(face >= 0, target.face_part[face], -1).reshape(counts.shape)
    normal = wireframe(target).face_normals[face].reshape(*counts.shape, 3)
    return unexplained_share(np.sqrt(counts), part, normal, len(target.part_names), _MOST)
