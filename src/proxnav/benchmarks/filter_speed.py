"""How long one prediction and one update take on one core."""

import time
from collections.abc import Callable

import numpy as np

from proxnav.geometry import Camera, quaternion
from proxnav.geometry.celestial import EARTH_EQUATORIAL_RADIUS, MU_EARTH
from proxnav.navigation.belief import Scene
from proxnav.navigation.config import GateConfig, NavigationConfig
from proxnav.navigation.kernels.prediction import advance
from proxnav.navigation.kernels.relative import gradient_transition
from proxnav.navigation.kernels.update import keypoint_model, keypoint_update
from proxnav.navigation.layout import FIXED, X_FIXED
from proxnav.navigation.navigator import make_scene
from proxnav.targets.loading import load_target


def measure_speed(camera: Camera, target: str, repeats: int = 400) -> dict[str, float]:
    """Milliseconds: median and best of `repeats`, all keypoints seen and accepted."""
    points = np.ascontiguousarray(load_target(target).keypoints_m)
    k = len(points)
    x = np.zeros(X_FIXED + 2 * k + 6)
    P = np.diag(np.r_[np.full(3, 0.1), np.full(FIXED - 3, 1e-3), np.ones(2 * k), np.full(6, 0.02)] ** 2)
    x[0], x[6:10], x[10] = -30.0, quaternion.from_matrix(np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])), 1.0
    lens = np.array([camera.fx, camera.fy, camera.cx, camera.cy])
    index, noise, scene = np.arange(k), NavigationConfig().noise_vector(True), _scene(points, camera)
    gates, none, cov = GateConfig(), np.zeros(3), np.tile(2.0 * np.eye(2), (k, 1, 1))
    frame_gates = gates.frame_gates(2 * k)

    errors = np.diag(np.r_[np.full(3, 0.1), np.full(3, 0.01)] ** 2)

    def predict() -> tuple:
        Phi, held = gradient_transition(*scene.ephemeris, 10.0, 1.0), scene.held(10.0)
        return advance(x, P, Phi, 1.0, none, none, held, errors, noise)

    moved, spread, _, _ = predict()
    pixels = keypoint_model(moved, points, index, np.eye(3), lens)[0].reshape(-1, 2)

    def update() -> tuple:
        return keypoint_update(
            moved,
            spread,
            pixels,
            cov,
            points,
            index,
            np.eye(3),
            lens,
            scene.shares,
            gates.keypoint_gate(),
            frame_gates,
            0.5,
        )

    accepted = int(update()[3].sum())
    first, second = _times(predict, repeats), _times(update, repeats)
    return {
        "keypoints": k, "accepted": accepted, "states": len(P), "predict_ms": float(np.median(first)),
        "update_ms": float(np.median(second)), "both_median_ms": float(np.median(first) + np.median(second)),
        "both_best_ms": float(first.min() + second.min()),
    }  # fmt: skip


def _scene(points_m: np.ndarray, camera: Camera) -> Scene:
    """A circular orbit at 400 km."""
    radius, t = EARTH_EQUATORIAL_RADIUS + 400e3, np.arange(0.0, 100.0, 30.0)
    n = float(np.sqrt(MU_EARTH / radius**3))
    r = radius * np.stack([np.cos(n * t), np.sin(n * t), np.zeros_like(t)], axis=1)
    v = n * radius * np.stack([-np.sin(n * t), np.cos(n * t), np.zeros_like(t)], axis=1)
    return make_scene((t, r, v), points_m, camera, NavigationConfig(), True)


def _times(job: Callable[[], tuple], repeats: int) -> np.ndarray:
    found = np.empty(repeats)
    for i in range(repeats):
        start = time.perf_counter()
        job()
        found[i] = 1e3 * (time.perf_counter() - start)
    return found
