"""Poses round a prior one, laid onto the image from coarse to fine: the best, and whether another is nearly as good."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera, Pose
from proxnav.geometry.perturbation import difference, moved
from proxnav.geometry.types import GreyImage, PoseCovariance
from proxnav.pose.align.prior import Prior
from proxnav.pose.align.refine import FINE, ROUGH, Round, Schedule, refine
from proxnav.pose.align.score import Sampling, edge_share, score
from proxnav.pose.align.target_crop import TargetCrop, target_box
from proxnav.targets import Target

COARSE = Schedule(2.0, (Round(1.5, 8.0, (5.0, 4.0, 3.0), 2.5), Round(1.0, 6.0, (2.5, 2.0), 2.5)))
"""Steps on the smallest picture, where eight pixels are the most of the target's size."""
_COARSE_SIDE_PX, _ROUGH_SIDE_PX, _FINE_SIDE_PX = 96, 224, 448
_WIDE, _CLOSE = 1.5, 1.2
"""Side of the square looked at over the longer side of the target's box: wide where the place is not yet known."""
STEP_RAD = np.deg2rad(11.0)
"""Distance of neighbouring attitudes of a search: half of it is what the coarse steps mend."""
_KEPT, _FINISHED = 5, 3
"""Poses, the best by their score, that are refined roughly and finely."""
APART_RAD, APART_SHARE = np.deg2rad(4.0), 0.03
"""Attitude, and place as a share of the range, from which on two poses are different ones."""
_AFTER_COARSE, _AFTER_ROUGH, _AFTER_FINE = Sampling(1.0, 3.0), Sampling(0.7, 3.0), Sampling(0.5, 2.0)


@dataclass(frozen=True, slots=True, eq=False)
class Laid:
    """A pose laid onto the image."""

    T_cam_target: Pose
    covariance: PoseCovariance
    """Covariance of (dt, dr) by outline and prior, as if points of the outline erred apart."""
    edge_share: float
    """Share of the outline that lies on edges of the image."""
    score: float
    lead: float = np.inf
    """Score by which it is better than the best pose elsewhere; infinite where none was tried."""


def laid(grey: GreyImage, camera: Camera, target: Target, prior: Prior) -> Laid | None:
    """The prior's pose laid onto the image; None where the target is not in it or shows too few lines."""
    crop = _crop(grey, camera, target, prior.T_cam_target, _CLOSE, _ROUGH_SIDE_PX)
    rough = None if crop is None else refine(target, prior.T_cam_target, crop, prior, ROUGH)
    return None if rough is None else _finished(grey, camera, target, rough.T_cam_target, prior)


def searched(grey: GreyImage, camera: Camera, target: Target, prior: Prior, reach_rad: float) -> Laid | None:
    """The best of all poses whose attitude is up to `reach_rad` away from the prior's."""
    crop = _crop(grey, camera, target, prior.T_cam_target, _WIDE, _COARSE_SIDE_PX)
    if crop is None:
        return None
    starts = [moved(prior.T_cam_target, np.r_[np.zeros(3), turn]) for turn in turns(reach_rad)]
    tried = _best(target, starts, crop, prior, COARSE, _AFTER_COARSE, _KEPT)
    crop = _crop(grey, camera, target, tried[0], _CLOSE, _ROUGH_SIDE_PX) if tried else None
    if crop is None:
        return None
    tried = _best(target, tried, crop, prior, ROUGH, _AFTER_ROUGH, _FINISHED)
    found = [_finished(grey, camera, target, pose, prior) for pose in tried]
    return _leading([one for one in found if one is not None])


def turns(reach_rad: float) -> Float[np.ndarray, "n 3"]:
    """Rotation vectors [rad] of a cubic lattice within a ball; the middle first."""
    n = int(reach_rad / STEP_RAD + 1e-9)
    line = np.arange(-n, n + 1) * STEP_RAD
    lattice = np.stack(np.meshgrid(line, line, line, indexing="ij"), axis=-1).reshape(-1, 3)
    length = np.linalg.norm(lattice, axis=1)
    order = np.argsort(length, kind="stable")
    return lattice[order][length[order] <= reach_rad + 1e-9]


def differ(one: Pose, other: Pose) -> bool:
    """Whether two poses are more apart than two answers of one search."""
    d = difference(one, other)
    far = np.linalg.norm(d[:3]) > APART_SHARE * np.linalg.norm(one.t_m)
    return bool(far or np.linalg.norm(d[3:]) > APART_RAD)


def _crop(grey: GreyImage, camera: Camera, target: Target, pose: Pose, margin: float, side: int) -> TargetCrop | None:
    box = target_box(target, pose, camera)
    return None if box is None else TargetCrop.around(grey, box, camera, margin, side)


def _best(
    target: Target,
    starts: list[Pose],
    crop: TargetCrop,
    prior: Prior,
    schedule: Schedule,
    sampling: Sampling,
    count: int,
) -> list[Pose]:
    """The best `count` different poses that the starts lead to, by their score."""
    ends = [refine(target, start, crop, prior, schedule) for start in starts]
    poses = [end.T_cam_target for end in ends if end is not None]
    order = np.argsort([-score(target, pose, crop, prior, sampling) for pose in poses], kind="stable")
    kept: list[Pose] = []
    for i in order:
        if len(kept) < count and all(differ(pose, poses[i]) for pose in kept):
            kept.append(poses[i])
    return kept


def _finished(grey: GreyImage, camera: Camera, target: Target, pose: Pose, prior: Prior) -> Laid | None:
    crop = _crop(grey, camera, target, pose, _CLOSE, _FINE_SIDE_PX)
    fine = None if crop is None else refine(target, pose, crop, prior, FINE)
    if crop is None or fine is None:
        return None
    share = edge_share(target, fine.T_cam_target, crop, _AFTER_FINE)
    reached = score(target, fine.T_cam_target, crop, prior, _AFTER_FINE)
    return Laid(fine.T_cam_target, np.linalg.inv(fine.information), share, reached)


def _leading(found: list[Laid]) -> Laid | None:
    """The best pose with its lead over the best that differs from it."""
    if not found:
        return None
    best = max(found, key=lambda one: one.score)
    others = [one.score for one in found if differ(best.T_cam_target, one.T_cam_target)]
    return Laid(
        best.T_cam_target, best.covariance, best.edge_share, best.score, best.score - max(others, default=-np.inf)
    )
