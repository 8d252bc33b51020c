"""How well a pose explains an image: its outline on edges, its parts in one tone each, its distance from the prior."""

import numpy as np

from proxnav.geometry import Pose
from proxnav.pose.align.config import AlignConfig
from proxnav.pose.align.kernels.edges import share_on_edges
from proxnav.pose.align.kernels.regions import unexplained_share
from proxnav.pose.align.outline import outline
from proxnav.pose.align.prior import Prior
from proxnav.pose.align.view import View
from proxnav.pose.align.wireframe import wireframe
from proxnav.targets import Target
from proxnav.targets.keypoints.visibility import first_faces

_MOST = 3.0
"""Residual in roots of counts above which a pixel says no more: shadow, texture."""


def evidence(
    target: Target, T_cam_target: Pose, view: View, prior: Prior, blur_px: float, spacing_px: float, config: AlignConfig
) -> float:
    """Larger is better; compares poses within one image."""
    lines = edge_share(target, T_cam_target, view, blur_px, spacing_px)
    regions = -np.log(max(region_misfit(target, T_cam_target, view, config.region_side), 1e-3))
    far = min(prior.distance2(T_cam_target), config.prior_most)
    return lines + config.region_weight * float(regions) - config.prior_weight * far


def edge_share(target: Target, T_cam_target: Pose, view: View, blur_px: float, spacing_px: float) -> float:
    """Share in [0, 1] of the outline that lies on edges of the image; 0 for less than ten points."""
    R, t = T_cam_target.R, T_cam_target.t_m
    lines = outline(target, R, t, view, spacing_px)
    if len(lines.points_m) < 10:
        return 0.0
    gx, gy = view.gradients(blur_px)
    noise = 0.5 + 2.0 * view.noise
    return share_on_edges(lines.points_m, lines.normals, R, t, view.lens, gx, gy, noise)


def region_misfit(target: Target, T_cam_target: Pose, view: View, side: int) -> float:
    """Share in [0, 1] of the image's scatter that smoothly shaded parts before a plain sky leave unexplained."""
    counts, camera = view.grid(side)
    rows, columns = np.indices(counts.shape) + 0.5
    rays = camera.unproject(np.stack([columns.ravel(), rows.ravel()], axis=1)) @ T_cam_target.R
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    eye = -T_cam_target.R.T @ T_cam_target.t_m
    _, face = first_faces(target, np.broadcast_to(eye, rays.shape), np.nan_to_num(rays, nan=0.0))
    part = np.where(face >= 0, target.face_part[face], -1).reshape(counts.shape)
    normal = wireframe(target).face_normals[face].reshape(*counts.shape, 3)
    return unexplained_share(np.sqrt(counts), part, normal, len(target.part_names), _MOST)
