"""How long one prediction and one update take on one core."""

import time
from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera, quaternion
from proxnav.geometry.celestial import EARTH_EQUATORIAL_RADIUS, MU_EARTH
from proxnav.geometry.types import Points
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import Ephemeris, FilterSetup, filter_setup
from proxnav.navigation.gates import POINT_GATE
from proxnav.navigation.kernels.dynamics import advance
from proxnav.navigation.kernels.gravity_gradient import gradient_transition
from proxnav.navigation.kernels.keypoints import keypoint_model, keypoint_update
from proxnav.navigation.layout import Covariance, E, StateVector, X, diagonal
from proxnav.targets.loading import load_target

_T, _DT = 10.0, 1.0


def measure_speed(camera: Camera, target: str, repeats: int = 400) -> dict[str, float]:
    """Milliseconds: median and best of `repeats`, all keypoints seen and accepted."""
    points = np.ascontiguousarray(load_target(target).keypoints_m)
    setup, k = _setup(points, camera), len(points)
    (x, P), index, none = _state(setup), np.arange(k), np.zeros(3)
    lens, cov, turning = setup.lens, np.tile(2.0 * np.eye(2), (k, 1, 1)), (np.eye(3), 0.0, none)
    errors = np.diag(np.r_[np.full(3, 0.1), np.full(3, 0.01)] ** 2)

    def predict() -> tuple:
        Phi, control = gradient_transition(*setup.ephemeris, _T, _DT), setup.control(_T)
        return advance(x, P, Phi, _DT, none, none, control, errors, setup.noise)

    moved, spread, _, _ = predict()
    pixels = keypoint_model(moved, points, index, turning, lens)[0].reshape(-1, 2)

    def update() -> tuple:
        return keypoint_update(
            moved, spread, pixels, cov, points, index, turning, lens, setup.shares, POINT_GATE, setup.frame_gates
        )

    _, _, _, used, _, _ = update()
    first, second = _times(predict, repeats), _times(update, repeats)
    return {
        "keypoints": k, "accepted": int(used.sum()), "states": len(P), "predict_ms": float(np.median(first)),
        "update_ms": float(np.median(second)), "both_median_ms": float(np.median(first) + np.median(second)),
        "both_best_ms": float(first.min() + second.min()),
    }  # fmt: skip


def _setup(points_m: Points, camera: Camera) -> FilterSetup:
    """A circular orbit at 400 km, each keypoint measured by itself."""
    radius, t = EARTH_EQUATORIAL_RADIUS + 400e3, np.arange(0.0, 100.0, 30.0)
    n = float(np.sqrt(MU_EARTH / radius**3))
    r = radius * np.stack([np.cos(n * t), np.sin(n * t), np.zeros_like(t)], axis=1)
    v = n * radius * np.stack([-np.sin(n * t), np.cos(n * t), np.zeros_like(t)], axis=1)
    return filter_setup(Ephemeris(t, r, v), points_m, camera, NavigationConfig(coupling="tight"), True)


def _state(setup: FilterSetup) -> tuple[StateVector, Covariance]:
    """30 m from the target, looking at it."""
    x, P = np.zeros(setup.layout.n_states), 1e-6 * np.eye(setup.layout.n_errors)
    x[X.position], x[X.q_cam_target] = [-30.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]
    x[X.q_eci_cam] = quaternion.from_matrix(np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]))
    points, pose = setup.layout.places(E.point_errors), setup.layout.places(E.pose_error)
    P[diagonal(E.position)], P[points, points], P[pose, pose] = 0.1**2, 1.0, 0.02**2
    return x, P


def _times(job: Callable[[], tuple], repeats: int) -> Float[np.ndarray, "n"]:
    found = np.empty(repeats)
    for i in range(repeats):
        start = time.perf_counter()
        job()
        found[i] = 1e3 * (time.perf_counter() - start)
    return found
