"""Truth and estimates with known errors for the tests of this room."""

import numpy as np

from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.geometry import Pose, quaternion, so3


def truth_along(rng: np.random.Generator, ranges_m: np.ndarray) -> dict[str, PoseRecord]:
    """Poses at the given ranges with random attitudes."""
    attitudes = quaternion.random(rng, len(ranges_m))
    poses = [Pose.from_wxyz("cam", "target", q, [0.0, 0.0, r]) for q, r in zip(attitudes, ranges_m, strict=True)]
    return {f"img{k:06d}.png": PoseRecord(f"img{k:06d}.png", T) for k, T in enumerate(poses)}


def disturbed(
    truth: dict[str, PoseRecord], covariance: np.ndarray, rng: np.random.Generator, claimed: float = 1.0
) -> dict[str, PoseRecord]:
    """Estimates whose errors follow `covariance`; they claim `claimed` times it."""
    found, half = {}, np.linalg.cholesky(covariance)
    for name, record in truth.items():
        delta, T = half @ rng.normal(size=6), record.T_cam_target
        assert T is not None
        T_est = Pose.from_matrix("cam", "target", so3.exp(delta[3:]).T @ T.R, T.t_m - delta[:3])
        found[name] = PoseRecord(name, T_est, "ok", claimed * covariance)
    return found
