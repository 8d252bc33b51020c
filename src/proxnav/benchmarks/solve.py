"""`estimate_pose` beside OpenCV and PoseLib on the same random cases: microseconds and errors."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.pose.solve.estimate import estimate_pose

_CAMERA = Camera(width=1024, height=1024, fx=1407.0, fy=1407.0, cx=512.0, cy=512.0)
_NOISE_PX = 1.0
_GATE_PX = 4.0  # given to all three
_OUTLIERS = 0.2
_HALF_SIZE_M = (4.0, 3.0, 1.5)
_LOST_RAD = np.radians(20.0)  # worse than this, or no pose, is a failure


@dataclass(frozen=True, slots=True, eq=False)
class _Case:
    T_true: Pose
    pixels: Float[np.ndarray, "n 2"]


Solver = Callable[[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 2"]], Pose | None]


def benchmark_solve(cases: int = 10_000, seed: int = 0, keypoints: Sequence[int] = (24, 6)) -> dict[str, Any]:
    """Time and error of each solver for each number of keypoints, and how many times faster ours is.

    A case: points uniform in a box of 8 x 6 x 3 m, any attitude, 10-100 m, 1 px of noise, a fifth of the keypoints
    anywhere in the image. Medians and percentiles count a case without a pose as 180 deg and an E_TN of 1; times are
    the median over blocks of cases, the solvers taking turns.
    """
    if cases < 1 or seed < 0:
        raise InputError(f"the benchmark needs at least 1 case and a seed from 0 on, found {cases}, {seed}")
    return {
        "cases": cases, "seed": seed, "noise_px": _NOISE_PX, "outliers": _OUTLIERS,
        **{f"{n}_keypoints": _compare(n, cases, seed) for n in keypoints},
    }  # fmt: skip


def _compare(n: int, cases: int, seed: int) -> dict[str, Any]:
    rng = np.random.default_rng((seed, n))
    points = rng.uniform(-1.0, 1.0, (n, 3)) * _HALF_SIZE_M
    drawn = [_draw(points, rng) for _ in range(cases)]
    blocks = [drawn[k : k + 100] for k in range(0, cases, 100)]
    solvers: dict[str, Solver] = {"proxnav": _proxnav, "opencv": _opencv, "poselib": _poselib}
    found: dict[str, list[Pose | None]] = {name: [] for name in solvers}
    times: dict[str, list[float]] = {name: [] for name in solvers}
    for solve in solvers.values():
        solve(points, drawn[0].pixels)  # first calls compile and load
    for block in blocks:
        for name, solve in solvers.items():
            start = time.perf_counter()
            found[name] += [solve(points, case.pixels) for case in block]
            times[name].append((time.perf_counter() - start) / len(block) * 1e6)
    rows: dict[str, Any] = {name: _row(found[name], drawn, times[name]) for name in solvers}
    ours = rows["proxnav"]["median_us"]
    for name in ("opencv", "poselib"):
        rows[name]["time_over_proxnav"] = rows[name]["median_us"] / ours
    return rows


def _draw(points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> _Case:
    n, z = len(points), rng.uniform(10.0, 100.0)
    x, y = rng.uniform(-0.15, 0.15, 2) * z
    T = Pose("cam", "target", quaternion.random(rng, 1)[0], np.array([x, y, z]))
    pixels = _CAMERA.project(T @ points) + _NOISE_PX * rng.normal(size=(n, 2))
    wrong = rng.permutation(n)[: round(_OUTLIERS * n)]
    pixels[wrong] = rng.uniform(0.0, 1024.0, (len(wrong), 2))
    return _Case(T, pixels)


def _row(found: Sequence[Pose | None], cases: Sequence[_Case], times: Sequence[float]) -> dict[str, float]:
    turn, shift = np.full(len(cases), np.pi), np.ones(len(cases))
    for k, (T, case) in enumerate(zip(found, cases, strict=True)):
        if T is not None:
            turn[k] = quaternion.angle_between(T.q_wxyz, case.T_true.q_wxyz)
            shift[k] = np.linalg.norm(T.t_m - case.T_true.t_m) / np.linalg.norm(case.T_true.t_m)
    turn_deg = np.degrees(turn)
    return {
        "median_us": float(np.median(times)),
        "median_e_r_deg": float(np.median(turn_deg)),
        "mean_e_r_deg": float(turn_deg.mean()),
        "p95_e_r_deg": float(np.percentile(turn_deg, 95.0)),
        "p99_e_r_deg": float(np.percentile(turn_deg, 99.0)),
        "median_e_tn": float(np.median(shift)),
        "p95_e_tn": float(np.percentile(shift, 95.0)),
        "without_pose": float(sum(T is None for T in found)),
        "failures": float((turn > _LOST_RAD).sum()),
    }


def _proxnav(points: Float[np.ndarray, "n 3"], pixels: Float[np.ndarray, "n 2"]) -> Pose | None:
    return estimate_pose(points, pixels, _CAMERA).T_cam_target


def _opencv(points: Float[np.ndarray, "n 3"], pixels: Float[np.ndarray, "n 2"]) -> Pose | None:
    """cv2.solvePnPRansac with its defaults and our gate, then solvePnPRefineLM on the inliers."""
    import cv2

    K = _CAMERA.K  # corner origin on both sides: the half pixel cancels
    try:
        ok, rvec, tvec, inliers = cv2.solvePnPRansac(points, pixels, K, None, reprojectionError=_GATE_PX)
        if not ok or inliers is None:
            return None
        used = inliers[:, 0]
        rvec, tvec = cv2.solvePnPRefineLM(points[used], pixels[used], K, None, rvec, tvec)  # pyright: ignore
    except cv2.error:
        return None
    q = quaternion.exp(rvec[:, 0])
    return Pose("cam", "target", q, tvec[:, 0]) if np.isfinite(q).all() and np.isfinite(tvec).all() else None


def _poselib(points: Float[np.ndarray, "n 3"], pixels: Float[np.ndarray, "n 2"]) -> Pose | None:
    """poselib.estimate_absolute_pose with its defaults and our gate."""
    try:
        import poselib
    except ImportError:
        raise InputError("the solvers' benchmark compares with PoseLib: pip install 'proxnav[benchmark]'") from None

    camera = {"model": "PINHOLE", "width": 1024, "height": 1024, "params": [1407.0, 1407.0, 512.0, 512.0]}
    pose, info = poselib.estimate_absolute_pose(pixels, points, camera, {"max_reproj_error": _GATE_PX}, {})
    return Pose("cam", "target", pose.q, pose.t) if info["num_inliers"] >= 4 else None
