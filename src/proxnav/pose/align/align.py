"""A keypoint pose made exact by the image itself: the outline of the known target is laid onto the image's edges."""

from dataclasses import dataclass

import numpy as np

from proxnav.geometry import Camera, Pose
from proxnav.geometry.perturbation import difference
from proxnav.pose.align.config import AlignConfig
from proxnav.pose.align.evidence import edge_share, evidence
from proxnav.pose.align.prior import Prior
from proxnav.pose.align.settle import FINE, ROUGH, settle
from proxnav.pose.align.view import View, target_box
from proxnav.targets import Target

DEFAULT = AlignConfig()


@dataclass(frozen=True, slots=True, eq=False)
class Alignment:
    """The pose, what it rests on, and how well it explains the image."""

    T_cam_target: Pose
    covariance: np.ndarray
    """(6, 6) as of `PoseResult`; it holds the distances to the other poses that explain the image nearly as well."""
    outline_covariance: np.ndarray
    """(6, 6) the part of it that `covariance_scale` multiplies, before that."""
    edge_share: float
    """Share of the outline that lies on edges of the image."""
    doubt: float
    """Of the keypoints that it started from."""


@dataclass(frozen=True, slots=True, eq=False)
class _Candidate:
    evidence: float
    T_cam_target: Pose
    covariance: np.ndarray


def align(
    grey: np.ndarray, camera: Camera, target: Target, prior: Prior, config: AlignConfig = DEFAULT
) -> Alignment | None:
    """The pose whose outline lies on the edges of a grey image (uint8), near the pose of the keypoints.

    Other starts along the axes of the keypoint pose's covariance are compared with it by their evidence, because an
    outline that is off by more than the distance of neighbouring edges is pulled to the wrong ones. None when the
    target is not in the image or shows too few lines.
    """
    view = _view(grey, camera, target, prior.T_cam_target, config.rough_side, config)
    if view is None:
        return None
    rough = []
    for start in _starts(target, prior, view, config):
        settled = settle(target, start, view, prior, ROUGH, config.prior_rough, config)
        if settled is not None:
            rough.append((evidence(target, settled.T_cam_target, view, prior, 0.7, 3.0, config), settled.T_cam_target))
    rough = sorted(rough, key=lambda pair: -pair[0])[: config.finished]
    view = _view(grey, camera, target, rough[0][1], config.fine_side, config) if rough else None
    if view is None:
        return None
    found = [_finished(start, view, target, prior, config) for _, start in rough]
    return _judged([one for one in found if one is not None], view, target, prior, config)


def _view(grey: np.ndarray, camera: Camera, target: Target, pose: Pose, side: int, config: AlignConfig) -> View | None:
    box = target_box(target, pose, camera)
    return None if box is None else View.around(grey, box, camera, config.margin, side)


def _starts(target: Target, prior: Prior, view: View, config: AlignConfig) -> list[Pose]:
    """The prior's pose and the best of the others."""
    others = prior.others(config.starts, config.spread)
    scores = [evidence(target, pose, view, prior, 1.5, 5.0, config) for pose in others]
    order = np.argsort(scores)[::-1][: config.settled]
    return [prior.T_cam_target, *(others[i] for i in order)]


def _finished(start: Pose, view: View, target: Target, prior: Prior, config: AlignConfig) -> _Candidate | None:
    settled = settle(target, start, view, prior, FINE, config.prior_fine, config)
    if settled is None:
        return None
    score = evidence(target, settled.T_cam_target, view, prior, 0.5, 2.0, config)
    return _Candidate(score, settled.T_cam_target, np.linalg.inv(settled.information))


def _judged(found: list[_Candidate], view: View, target: Target, prior: Prior, config: AlignConfig) -> Alignment | None:
    """The best pose; its covariance is that of the mixture of all, the keypoint pose among them, about it."""
    if not found:
        return None
    best = max(found, key=lambda one: one.evidence)
    untouched = evidence(target, prior.T_cam_target, view, prior, 0.5, 2.0, config)
    poses = [one.T_cam_target for one in found] + [prior.T_cam_target]
    scores = np.array([one.evidence for one in found] + [untouched])
    weights = np.exp((scores - scores.max()) / config.temperature)
    away = np.array([difference(best.T_cam_target, pose) for pose in poses])
    between = np.einsum("k,ki,kj->ij", weights / weights.sum(), away, away)
    share = edge_share(target, best.T_cam_target, view, 0.5, 2.0)
    alone = config.widening(prior.doubt) * best.covariance
    return Alignment(best.T_cam_target, config.covariance_scale * alone + between, alone, share, prior.doubt)
