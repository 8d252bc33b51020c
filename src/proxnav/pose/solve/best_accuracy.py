"""What pose accuracy a target's keypoints allow at best, by range: the Cramer-Rao bound over random views."""

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.pose.solve.crlb import cramer_rao_white
from proxnav.targets.keypoints.visibility import visible_keypoints
from proxnav.targets.target import Target

RANGES_M = (10.0, 20.0, 30.0, 50.0, 75.0, 100.0)
VIEWS = 120


def ranges_for(target: Target) -> tuple[float, ...]:
    """10 m to 100 m, farther in proportion for a craft whose radius exceeds 10 m."""
    return tuple(r * max(1.0, float(np.ceil(target.radius_m / 10.0))) for r in RANGES_M)


def accuracy_table(target: Target, camera: Camera, seed: int = 0) -> str:
    """Medians over random attitudes, each visible keypoint known to 1 px per axis."""
    lines = [
        f"best possible accuracy (Cramer-Rao bound, visible keypoints known to 1 px, camera of {camera.width} px, "
        f"fx {camera.fx:g} px):",
        f"  {'range [m]':>9}  {'lateral [m]':>11}  {'depth [m]':>9}  {'attitude [deg]':>14}  {'points seen':>11}",
    ]
    for range_m in ranges_for(target):
        lateral, depth, turn, seen = bound_at(target, range_m, camera, seed)
        row = (f"{lateral:11.3f}", f"{depth:9.3f}", f"{np.degrees(turn):14.2f}")
        cells = row if np.isfinite(lateral) else (f"{'-':>11}", f"{'-':>9}", f"{'-':>14}")
        lines.append(f"  {range_m:9.0f}  {'  '.join(cells)}  {seen:11.1f}")
    return "\n".join(lines)


def bound_at(target: Target, range_m: float, camera: Camera, seed: int = 0) -> Float[np.ndarray, "4"]:
    """Medians of: lateral sigma per axis [m], depth sigma [m], attitude sigma (root of the three) [rad], points seen.

    NaN where fewer than four points are seen in most views.
    """
    rng, rows = np.random.default_rng(seed), []
    for q in quaternion.random(rng, VIEWS):
        T = Pose.from_wxyz("cam", "target", q, [0.0, 0.0, range_m])
        seen = visible_keypoints(target, T) & camera.contains(camera.project(T @ target.keypoints_m))
        rows.append([*_sigmas(T, target.keypoints_m[seen], camera), float(seen.sum())])
    table = np.array(rows)
    known = np.isfinite(table[:, 0])
    if known.mean() < 0.5:
        return np.array([np.nan, np.nan, np.nan, float(np.median(table[:, 3]))])
    return np.append(np.median(table[known, :3], axis=0), np.median(table[:, 3]))


def _sigmas(T: Pose, points_m: np.ndarray, camera: Camera) -> tuple[float, float, float]:
    if len(points_m) < 4:
        return np.nan, np.nan, np.nan
    try:
        variances = np.diagonal(cramer_rao_white(T, points_m, camera))
    except InputError:  # all on one line
        return np.nan, np.nan, np.nan
    lateral = np.sqrt(0.5 * (variances[0] + variances[1]))
    return float(lateral), float(np.sqrt(variances[2])), float(np.sqrt(variances[3:].sum()))
