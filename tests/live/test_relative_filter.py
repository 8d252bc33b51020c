"""The filter in a loop knows where the target is from its own orbit and poses alone."""

import numpy as np

from navigation.flights import CAMERA, fly, points
from proxnav.flight.truth import Truth
from proxnav.live.relative_filter import ChaserState, RelativeFilter
from proxnav.navigation.config import SURVEYED, NavigationConfig
from proxnav.navigation.readings import PoseFix

COVARIANCE = np.diag([0.02, 0.02, 0.05, 0.002, 0.002, 0.002]) ** 2
LASTING = np.array([0.4, -0.3, 0.5])
"""Error that all poses share, in deviations."""


def state(truth: Truth, i: int) -> ChaserState:
    """The truth keeps mean rates over steps; the chaser knows the one of the instant."""
    rate = 0.5 * (truth.rate_cam[i] + truth.rate_cam[min(i + 1, len(truth) - 1)])
    gained = truth.specific_force[i] * truth.step_s
    return ChaserState(
        float(truth.t[i]), truth.r_eci_chaser_m[i], truth.v_eci_chaser_mps[i], truth.q_eci_cam[i], rate, gained
    )


def fix(truth: Truth, i: int, rng: np.random.Generator) -> PoseFix:
    """Errors as those of aligned poses: most of them last, a tenth of the deviation is new."""
    sigma, t = np.sqrt(np.diag(COVARIANCE))[:3], float(truth.t[i])
    error = sigma * (LASTING + 0.1 * rng.normal(size=3))
    return PoseFix(t, t, truth.q_cam_target[i], truth.t_cam_target_m[i] + error, COVARIANCE)


def test_the_relative_state_is_found_although_the_target_tells_nothing() -> None:
    truth, _ = fly(60.0)
    rng, count = np.random.default_rng(5), len(truth)
    found = RelativeFilter(points(), CAMERA, NavigationConfig(geometry=SURVEYED))
    for i in range(count):
        found.chaser(state(truth, i))
        if i % 4 == 0:
            assert found.pose(fix(truth, i, rng)).outcome in ("started", "accepted")
    last = found.at(float(truth.t[-1]))
    assert last is not None
    assert found.status == "tracking"
    rho, rho_dot = truth.relative
    assert np.linalg.norm(last.r_ric_m - rho[-1]) < 0.05  # m, at 30 m
    assert np.linalg.norm(last.v_ric_mps - rho_dot[-1]) < 0.01  # m/s
    assert np.all(np.abs(last.r_ric_m - rho[-1]) < 4.0 * np.sqrt(np.diag(last.covariance)[:3]))


def test_without_a_pose_nothing_is_known_and_a_pose_before_the_chaser_is_refused() -> None:
    truth, _ = fly(60.0)
    found = RelativeFilter(points(), CAMERA, NavigationConfig(geometry=SURVEYED))
    assert found.pose(fix(truth, 0, np.random.default_rng(0))).outcome == "invalid"
    assert (found.at(0.0), found.status) == (None, "waiting")
    found.chaser(state(truth, 0))
    assert (found.at(float(truth.t[0])), found.status) == (None, "waiting")
