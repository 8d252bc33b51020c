"""Score of the Pose Bowl challenge: how the camera moved along chains of images, each relative to the chain's first.

Errors of position and of attitude over the true motion, zero below 0.002173 and 0.169 deg (in rad), position at most
1000; their means over all images, added. As its published scoring script has it.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import Pose, quaternion

_SMALLEST = 4.0 * np.finfo(np.float64).eps
_LEAST_POSITION, _LEAST_TURN = 0.002173, np.radians(0.169)
_MOST_POSITION = 1e3

Chains = Mapping[tuple[str, int], Pose]
"""Poses of the camera by (chain, image)."""


@dataclass(frozen=True, slots=True)
class PoseBowlScore:
    """Mean errors over all images, the first of each chain among them."""

    images: int
    chains: int
    mean_translation_error: float
    mean_rotation_error: float
    score: float


def pose_bowl_score(estimates: Chains, truth: Chains) -> PoseBowlScore:
    """Score of estimates; InputError unless both are of the same images."""
    if set(estimates) != set(truth):
        extra = sorted(set(estimates) ^ set(truth))[0]
        raise InputError(f"image {extra[1]} of chain {extra[0]!a} is in one table alone; give both the same images")
    errors = np.array([_errors(estimates[key], T) for key, T in truth.items()])
    position, turn = errors.mean(axis=0).tolist()
    return PoseBowlScore(len(truth), len({chain for chain, _ in truth}), position, turn, position + turn)


def _errors(T_est: Pose, T_true: Pose) -> tuple[float, float]:
    moved, turned = float(np.linalg.norm(T_true.t_m)), float(np.linalg.norm(quaternion.log(T_true.q_wxyz)))
    position = min(float(np.linalg.norm(T_est.t_m - T_true.t_m)) / max(moved, _SMALLEST), _MOST_POSITION)
    turn = float(quaternion.angle_between(T_est.q_wxyz, T_true.q_wxyz)) / max(turned, _SMALLEST)
    return position if position >= _LEAST_POSITION else 0.0, turn if turn >= _LEAST_TURN else 0.0
