"""How long one prediction and one update take on one core."""

import time
from collections.abc import Callable

import numpy as np

from proxnav.geometry import Camera, quaternion
from proxnav.geometry.relative_motion import cw_transition
from proxnav.navigation.config import FilterNoise, GateConfig
from proxnav.navigation.kernels.prediction import advance
from proxnav.navigation.kernels.update import keypoint_model, keypoint_update
from proxnav.navigation.layout import FIXED, X_FIXED
from proxnav.targets.loading import load_target


def measure_speed(camera: Camera, target: str, repeats: int = 400) -> dict[str, float]:
    """Milliseconds: median and best of `repeats`, all keypoints seen and accepted."""
    points = np.ascontiguousarray(load_target(target).keypoints_m)
    k = len(points)
    x = np.zeros(X_FIXED + 2 * k)
    P = np.diag(np.r_[np.full(3, 0.1), np.full(FIXED - 3, 1e-3), np.ones(2 * k)] ** 2)
    x[0], x[6:10], x[10] = -30.0, quaternion.from_matrix(np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])), 1.0
    lens = np.array([camera.fx, camera.fy, camera.cx, camera.cy])
    index, noise, Phi = np.arange(k), FilterNoise().vector(True), cw_transition(1.13e-3, 1.0)
    gates, none, cov = GateConfig(), np.zeros(3), np.tile(2.0 * np.eye(2), (k, 1, 1))
    frame_gates = gates.frame_gates(2 * k)

    def predict() -> tuple:
        return advance(x, P, Phi, 1.0, none, none, noise)

    moved, spread, _, _ = predict()
    pixels = keypoint_model(moved, points, index, np.eye(3), lens)[0].reshape(-1, 2)

    def update() -> tuple:
        return keypoint_update(
            moved, spread, pixels, cov, points, index, np.eye(3), lens, 0.5, gates.keypoint_gate(), frame_gates, 0.5
        )

    accepted = int(update()[3].sum())
    first, second = _times(predict, repeats), _times(update, repeats)
    return {
        "keypoints": k, "accepted": accepted, "states": len(P), "predict_ms": float(np.median(first)),
        "update_ms": float(np.median(second)), "both_median_ms": float(np.median(first) + np.median(second)),
        "both_best_ms": float(first.min() + second.min()),
    }  # fmt: skip


def _times(job: Callable[[], tuple], repeats: int) -> np.ndarray:
    found = np.empty(repeats)
    for i in range(repeats):
        start = time.perf_counter()
        job()
        found[i] = 1e3 * (time.perf_counter() - start)
    return found
