"""A keypoint pose refined on the image itself: the outline of the known target is fitted to the image's edges."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, UInt8

from proxnav.geometry import Camera, Pose
from proxnav.geometry.perturbation import difference
from proxnav.geometry.types import PoseCovariance
from proxnav.pose.align.config import AlignConfig
from proxnav.pose.align.intrinsics import outline_moves
from proxnav.pose.align.prior import Prior
from proxnav.pose.align.refine import FINE, LAST_STEP, ROUGH, refine
from proxnav.pose.align.rivals import rivals
from proxnav.pose.align.score import Sampling, edge_share, score
from proxnav.pose.align.target_crop import TargetCrop, target_box
from proxnav.targets import Target

# Chosen on validation images (docs/alignment.md).
ROUGH_SIDE_PX, FINE_SIDE_PX = 224, 448
"""Sides of the square in which alternatives are compared, and the most of the one in which the pose is finished."""
MARGIN = 1.15
"""Side of the square over the longer side of the target's box."""
AXES, SIGMAS = 3, (-3.5, 3.5)
"""Axes of the keypoint pose's covariance along which alternatives lie, and how many standard deviations away."""
ALTERNATIVES = 2
"""Alternatives, the best by their score, that are refined roughly beside the keypoint pose."""
FINISHED = 2
"""Rough poses, the best by their score, that are refined finely."""
TEMPERATURE = 0.05
"""Score by which a pose must be better to count e times as much in the covariance."""
CLEARLY = 0.05
"""Score by which the other pose of a nearly symmetric craft must be better to be believed against the keypoints."""
_AT_START, _AFTER_ROUGH, _AFTER_FINE = Sampling(1.5, 5.0), Sampling(0.7, 3.0), Sampling(0.5, 2.0)
DEFAULT = AlignConfig()


@dataclass(frozen=True, slots=True, eq=False)
class Alignment:
    """The pose, what it rests on, and how well it explains the image."""

    T_cam_target: Pose
    covariance: PoseCovariance
    """Covariance of (dt, dr) as in `PoseResult`, the distances to the other poses that explain the image nearly as well
    among it."""
    outline_covariance: PoseCovariance
    """The part of it that `covariance_scale` multiplies, before that."""
    score: float
    """How well the pose explains the image; compares poses within one image."""
    edge_share: float
    """Share of the outline that lies on edges of the image."""
    doubt: float
    """1 - median score of the keypoints that it started from."""
    calibration_moves: Float[np.ndarray, "6 calibration=3"]
    """As in `PoseResult`; `covariance` holds them."""


@dataclass(frozen=True, slots=True, eq=False)
class _Candidate:
    score: float
    T_cam_target: Pose
    covariance: PoseCovariance


def align(
    grey: UInt8[np.ndarray, "height width"],
    camera: Camera,
    target: Target,
    prior: Prior,
    config: AlignConfig = DEFAULT,
) -> Alignment | None:
    """The pose whose outline lies on the edges of a grey image, near the pose of the keypoints.

    Alternatives along the axes of the keypoint pose's covariance are compared with it by their score, because an
    outline that is off by more than the distance of neighbouring edges is pulled to the wrong ones. None when the
    target is not in the image or shows too few lines.
    """
    crop = _crop(grey, camera, target, prior.T_cam_target, ROUGH_SIDE_PX)
    if crop is None:
        return None
    rough = []
    for start in _starts(target, prior, crop):
        refined = refine(target, start, crop, prior, ROUGH)
        if refined is not None:
            rough.append((score(target, refined.T_cam_target, crop, prior, _AFTER_ROUGH), refined.T_cam_target))
    rough = sorted(rough, key=lambda pair: -pair[0])[:FINISHED]
    crop = _crop(grey, camera, target, rough[0][1], FINE_SIDE_PX) if rough else None
    if crop is None:
        return None
    finished = [_finished(start, crop, target, prior) for _, start in rough]
    found = [one for one in finished if one is not None]
    return _judged(found + _better_rivals(found, crop, target, prior), crop, target, prior, config)


def _crop(
    grey: UInt8[np.ndarray, "height width"], camera: Camera, target: Target, pose: Pose, side: int
) -> TargetCrop | None:
    box = target_box(target, pose, camera)
    return None if box is None else TargetCrop.around(grey, box, camera, MARGIN, side)


def _starts(target: Target, prior: Prior, crop: TargetCrop) -> list[Pose]:
    """The prior's pose and the best of the alternatives."""
    alternatives = prior.alternatives(AXES, SIGMAS)
    scores = [score(target, pose, crop, prior, _AT_START) for pose in alternatives]
    order = np.argsort(scores)[::-1][:ALTERNATIVES]
    return [prior.T_cam_target, *(alternatives[i] for i in order)]


def _finished(start: Pose, crop: TargetCrop, target: Target, prior: Prior) -> _Candidate | None:
    refined = refine(target, start, crop, prior, FINE)
    if refined is None:
        return None
    reached = score(target, refined.T_cam_target, crop, prior, _AFTER_FINE)
    return _Candidate(reached, refined.T_cam_target, np.linalg.inv(refined.information))


def _better_rivals(found: list[_Candidate], crop: TargetCrop, target: Target, prior: Prior) -> list[_Candidate]:
    """Poses for which the best one may be mistaken, where the image clearly likes them better."""
    if not found:
        return []
    best = max(found, key=lambda one: one.score)
    tried = [_rival(pose, crop, target, prior) for pose in rivals(target, best.T_cam_target)]
    return [one for one in tried if one is not None and one.score > best.score + CLEARLY]


def _rival(pose: Pose, crop: TargetCrop, target: Target, prior: Prior) -> _Candidate | None:
    """A rival laid onto the image from where it is, scored as all others are."""
    there = replace(prior, T_cam_target=pose)
    rough = refine(target, pose, crop, there, ROUGH)
    refined = None if rough is None else refine(target, rough.T_cam_target, crop, there, FINE)
    if refined is None:
        return None
    reached = score(target, refined.T_cam_target, crop, prior, _AFTER_FINE)
    return _Candidate(reached, refined.T_cam_target, np.linalg.inv(refined.information))


def _judged(
    found: list[_Candidate], crop: TargetCrop, target: Target, prior: Prior, config: AlignConfig
) -> Alignment | None:
    """The best pose; its covariance is that of the mixture of all, the keypoint pose among them, about it."""
    if not found:
        return None
    best = max(found, key=lambda one: one.score)
    of_keypoints = score(target, prior.T_cam_target, crop, prior, _AFTER_FINE)
    poses = [one.T_cam_target for one in found] + [prior.T_cam_target]
    scores = np.array([one.score for one in found] + [of_keypoints])
    weights = np.exp((scores - scores.max()) / TEMPERATURE)
    away = np.array([difference(best.T_cam_target, pose) for pose in poses])
    between = np.einsum("k,ki,kj->ij", weights / weights.sum(), away, away)
    share = edge_share(target, best.T_cam_target, crop, _AFTER_FINE)
    alone = config.widening(prior.doubt) * best.covariance
    moves = outline_moves(target, best.T_cam_target, crop, prior, *LAST_STEP)
    covariance = config.covariance_scale * alone + between + moves @ moves.T
    return Alignment(best.T_cam_target, covariance, alone, best.score, share, prior.doubt, moves)
