"""A pose moved until the view that it predicts lies on the picture: all shades of the craft, not only its lines.

The predicted view is warped as its depths say the pose moves it (direct alignment: B. Lucas and T. Kanade, "An
iterative image registration technique", IJCAI 1981; S. Baker and I. Matthews, "Lucas-Kanade 20 years on", IJCV 2004),
so that one drawn view a step is enough. What is compared are tones less the mean and over the contrast of their
surroundings, which forgives exposure, albedo and Earth's share of the light.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera, Pose
from proxnav.geometry.perturbation import difference, moved
from proxnav.geometry.pose_jacobian import pose_jacobian
from proxnav.geometry.types import PoseCovariance
from proxnav.pose.local_contrast import SATURATED, Inside, View, standardised, tones

# Chosen on 60 ray-cast frames, docs/alignment.md.
_ALIKE = 30.0
"""Neighbouring pixels that say the same: factor on the variance of the residuals while the pose is moved."""
_HONEST = 500.0
"""The same factor in the covariance: a drawn view errs in ways that its pixels share."""
_ROBUST = 2.0
"""Residual, in robust standard deviations, at which a pixel's weight is a half (Cauchy)."""
_FEWEST = 50
"""Pixels without which nothing is said."""


@dataclass(frozen=True, slots=True, eq=False)
class PredictedView:
    """The view that a pose predicts."""

    T_cam_target: Pose
    camera: Camera
    """Camera whose image the view is."""
    light: View
    """Linear, in any unit, the sky behind the craft included."""
    depth_m: View
    """Along the camera's z axis; anything outside the mask."""
    mask: Inside
    """Where the view shows the craft and the picture shows anything."""


@dataclass(frozen=True, slots=True, eq=False)
class PhotometricEquations:
    """Normal equations H d = g of a step d = (dt [m], dr [rad]), camera axes, and the variance of the residuals."""

    H: Float[np.ndarray, "6 6"]
    g: Float[np.ndarray, "6"]
    variance: float

    def step(self, T_cam_target: Pose, prior: Pose, information: Float[np.ndarray, "6 6"]) -> Pose:
        """The likeliest pose between the picture and a prior with its information matrix."""
        weight = 1.0 / (_ALIKE * self.variance)
        towards_prior = information @ difference(T_cam_target, prior)
        return moved(T_cam_target, np.linalg.solve(weight * self.H + information, weight * self.g + towards_prior))

    def covariance(self, information: Float[np.ndarray, "6 6"]) -> PoseCovariance:
        """Covariance of that pose."""
        return np.linalg.inv(self.H / (_HONEST * self.variance) + information)


def photometric_equations(view: PredictedView, seen: View, window_px: float) -> PhotometricEquations | None:
    """The equations of one step from a predicted view and the seen one [counts of 255]; None where too little shows."""
    if np.count_nonzero(view.mask) < _FEWEST:
        return None
    predicted, contrast_p = standardised(tones(view.light, view.mask), view.mask, window_px)
    picture, contrast_i = standardised(tones(seen, view.mask), view.mask, window_px)
    residual = (picture - predicted)[view.mask]
    importance = np.hypot(contrast_p, contrast_i)[view.mask]
    spread = 1.4826 * float(np.median(np.abs(residual))) + 1e-9
    weight = importance / (1.0 + (residual / (_ROBUST * spread)) ** 2) * (seen[view.mask] < SATURATED)
    if not weight.sum() > 0.0:
        return None
    J = _flow(view, predicted)
    variance = float((weight * residual**2).sum() / weight.sum())
    weight = weight / importance.mean()
    return PhotometricEquations(J.T @ (weight[:, None] * J), J.T @ (weight * residual), variance)


def _flow(view: PredictedView, predicted: View) -> Float[np.ndarray, "n 6"]:
    """d(tone)/d(dt, dr) of the pixels in the mask: each tone moves with the surface point that it shows."""
    gradient = [cv2.Scharr(predicted, cv2.CV_64F, dx, 1 - dx, scale=1.0 / 32.0)[view.mask] for dx in (1, 0)]
    rows, columns = np.nonzero(view.mask)
    rays = view.camera.unproject(np.stack([columns, rows], axis=1) + 0.5)
    X = rays / rays[:, 2:] * view.depth_m[view.mask][:, None]
    moves = pose_jacobian(view.T_cam_target, view.T_cam_target.inverse() @ X, view.camera)
    return -np.einsum("ni,nij->nj", np.stack(gradient, axis=1), moves)
