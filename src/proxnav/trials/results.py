"""What came of a trial: the pose before any verdict, its evidence, and how wrong it is."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.evaluation.pairing import HAZARDOUS_NEES, HAZARDOUS_RAD, HAZARDOUS_TN
from proxnav.geometry import Pose
from proxnav.geometry.mahalanobis import squared_mahalanobis
from proxnav.geometry.perturbation import difference
from proxnav.geometry.pose_errors import pose_errors
from proxnav.pose.trust import Evidence, Similarity
from proxnav.records import PoseResult
from proxnav.trials.conditions import TrialScene


@dataclass(frozen=True, slots=True, eq=False)
class TrialResult:
    """One frame's answer."""

    key: str
    condition: str
    has_truth: bool
    """False where the picture does not show the target: every pose is wrong."""
    truth: Pose
    status: str
    """Before the verdict."""
    T_cam_target: Pose | None = None
    covariance: Float[np.ndarray, "6 6"] | None = None
    evidence: Evidence | None = None
    refined: Pose | None = None
    """The pose where the Sun is told; None without a pose."""
    refined_covariance: Float[np.ndarray, "6 6"] | None = None

    @staticmethod
    def of(trial: TrialScene, result: PoseResult, told: PoseResult, evidence: Evidence | None) -> "TrialResult":
        """From what the estimator said before the Sun was told and after, with the evidence after."""
        return TrialResult(
            trial.key, trial.condition, trial.has_truth, trial.scene.T_cam_target, result.status, result.T_cam_target,
            result.covariance, evidence, told.T_cam_target, told.covariance,
        )  # fmt: skip

    def told(self) -> "TrialResult":
        """The pose and its evidence where the Sun is told."""
        if self.refined is None:
            return self
        return replace(self, T_cam_target=self.refined, covariance=self.refined_covariance)

    def untold(self) -> "TrialResult":
        """The same where it is not."""
        return self if self.evidence is None else replace(self, evidence=self.evidence.seen(None))

    @property
    def errors(self) -> Float[np.ndarray, "6"]:
        """(dt [m], dr [rad]) from the pose to the truth, camera axes."""
        assert self.T_cam_target is not None
        return difference(self.T_cam_target, self.truth)

    @property
    def e_c(self) -> float:
        """E_C of the pose."""
        assert self.T_cam_target is not None
        return pose_errors(self.T_cam_target, self.truth).e_c

    @property
    def nees(self) -> float:
        """Squared Mahalanobis error."""
        assert self.covariance is not None
        return float(squared_mahalanobis(self.errors, self.covariance))

    @property
    def is_hazardous(self) -> bool:
        """Whether the pose is wrong by size, by its covariance, or shows what is not there."""
        if self.T_cam_target is None:
            return False
        found = pose_errors(self.T_cam_target, self.truth)
        wrong = found.e_r_rad > HAZARDOUS_RAD or found.e_tn > HAZARDOUS_TN or self.nees > HAZARDOUS_NEES
        return not self.has_truth or bool(wrong)


def with_pose(results: Sequence[TrialResult]) -> list[TrialResult]:
    """Those that have a pose and evidence about it."""
    return [one for one in results if one.T_cam_target is not None and one.evidence is not None]


def to_json(result: TrialResult) -> dict[str, Any]:
    """As JSON content."""
    T, covariance, evidence, refined = result.T_cam_target, result.covariance, result.evidence, result.refined
    return {
        "key": result.key, "condition": result.condition, "has_truth": result.has_truth,
        "truth": _numbers(result.truth),
        "status": result.status, "pose": None if T is None else _numbers(T),
        "covariance": _flat(covariance),
        "refined": None if refined is None else _numbers(refined),
        "refined_covariance": _flat(result.refined_covariance),
        "evidence": None if evidence is None else asdict(evidence),
    }  # fmt: skip


def from_json(content: dict[str, Any]) -> TrialResult:
    """Inverse of `to_json`."""
    pose, refined, evidence = content["pose"], content["refined"], content["evidence"]
    return TrialResult(
        content["key"], content["condition"], content["has_truth"], _pose(content["truth"]), content["status"],
        None if pose is None else _pose(pose),
        _matrix(content["covariance"]),
        None if evidence is None else _evidence(evidence),
        None if refined is None else _pose(refined),
        _matrix(content["refined_covariance"]),
    )  # fmt: skip


def _flat(matrix: Float[np.ndarray, "6 6"] | None) -> list[float] | None:
    return None if matrix is None else np.asarray(matrix).ravel().tolist()


def _matrix(numbers: list[float] | None) -> Float[np.ndarray, "6 6"] | None:
    return None if numbers is None else np.array(numbers).reshape(6, 6)


def _numbers(T: Pose) -> list[float]:
    return [*T.q_wxyz.tolist(), *T.t_m.tolist()]


def _pose(numbers: list[float]) -> Pose:
    return Pose.from_wxyz("cam", "target", numbers[:4], numbers[4:])


def _evidence(content: dict[str, Any]) -> Evidence:
    view = content["view"]
    rest = {name: float(value) for name, value in content.items() if name != "view"}
    return Evidence(**rest, view=None if view is None else Similarity(**view))
