"""Combined errors of one pose, computed by hand."""

import numpy as np
import pytest

from proxnav.evaluation.combined_errors import COMBINED, laboratory_score, spec2021_score
from proxnav.geometry import Pose
from proxnav.geometry.pose_errors import pose_errors


def pose(t_m: list[float], turn_deg: float = 0.0) -> Pose:
    half = np.radians(turn_deg) / 2.0
    return Pose.from_wxyz("cam", "target", [np.cos(half), np.sin(half), 0.0, 0.0], t_m)


@pytest.mark.parametrize(
    ("turn_deg", "shift_m", "spec", "laboratory"),
    [
        (0.168, 0.0217, 0.0, 0.0),
        (0.170, 0.0217, np.radians(0.170), 0.0),
        (0.168, 0.0218, 0.00218, 0.0),
        (0.6, 0.06, np.radians(0.6) + 0.006, np.radians(0.6) + 0.006),
        (0.6, 0.04, np.radians(0.6) + 0.004, np.radians(0.6)),
    ],
)
def test_dead_zones_apply_to_each_term(turn_deg: float, shift_m: float, spec: float, laboratory: float) -> None:
    errors = pose_errors(pose([shift_m, 0.0, 10.0], turn_deg), pose([0.0, 0.0, 10.0]))
    assert spec2021_score(errors) == pytest.approx(spec, abs=1e-9)
    assert laboratory_score(errors) == pytest.approx(laboratory, abs=1e-9)


def test_named_definitions_by_hand() -> None:
    errors = pose_errors(pose([3.0, 0.0, 104.0], 18.0), pose([0.0, 0.0, 100.0]))
    turn = np.pi / 10.0
    expected = {
        "e_tn + e_r [rad]": 0.05 + turn,
        "e_tn + e_r / pi": 0.05 + 0.1,
        "mean axis e_t / range + e_r [rad]": 7.0 / 3.0 / 100.0 + turn,
        "e_t [m] + e_r [rad]": 5.0 + turn,
    }
    for name, value in expected.items():
        assert COMBINED[name](errors) == pytest.approx(value, abs=1e-9)
