"""Trial results that were never drawn."""

import numpy as np

from proxnav.geometry import Pose
from proxnav.geometry.perturbation import moved
from proxnav.pose.trust import Evidence, Similarity
from proxnav.trials.results import TrialResult

SIGMA = np.array([0.02, 0.02, 0.1, 0.005, 0.005, 0.005])


def made(index: int, wrong: bool, condition: str = "nominal", has_truth: bool = True, seed: int = 0) -> TrialResult:
    """A good pose with good evidence, or one that is turned by 30 deg with bad evidence."""
    rng = np.random.default_rng([seed, index, wrong])
    T = Pose.from_wxyz("cam", "target", [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, rng.uniform(20.0, 80.0)])
    step = SIGMA * rng.normal(size=6) + wrong * np.array([0.0, 0.0, 0.0, 0.5, 0.0, 0.0])
    bad = float(wrong)
    evidence = Evidence(
        0.995 - 0.1 * bad * rng.random(), 0.75 - 0.3 * bad * rng.random(), 0.02 + 0.1 * bad * rng.random(), 0.004,
        rng.random(), Similarity(float(np.clip(0.88 - 0.5 * bad + 0.05 * rng.normal(), -1.0, 1.0)), 0.1),
    )  # fmt: skip
    return TrialResult(
        f"{condition}/{index}", condition, has_truth, T, "ok", moved(T, step), np.diag(SIGMA**2), evidence
    )  # fmt: skip


def many_made(good: int, wrong: int, condition: str = "nominal", seed: int = 0) -> list[TrialResult]:
    """So many good ones and so many wrong ones."""
    return [made(k, k >= good, condition, seed=seed) for k in range(good + wrong)]
