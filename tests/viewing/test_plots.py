"""Figures show what they were given, with quantity, unit and frame."""

import io
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from proxnav.errors import InputError
from proxnav.trajectories import HoldConfig, hold, walking_safety_ellipse
from proxnav.viewing.plots import errors_by_range, learning_curve, trajectory_ric


def _drawn(figure: Figure) -> Figure:
    figure.savefig(io.BytesIO(), format="png", dpi=40)
    return figure


def test_errors_are_drawn_at_their_range_and_half_turns_apart(rng: np.random.Generator) -> None:
    range_m, e_t_m, e_r_rad = rng.uniform(10, 100, 50), rng.uniform(0.1, 1, 50), rng.uniform(0.01, 0.1, 50)
    e_r_rad[7] = 3.0
    upper, lower = _drawn(errors_by_range(range_m, e_t_m, e_r_rad)).axes
    poses, turned, median = lower.lines
    assert len(poses.get_xdata()) == 49
    np.testing.assert_allclose(turned.get_xydata(), [[range_m[7], np.degrees(3.0)]])
    assert len(median.get_xdata()) > 3
    assert "[m]" in upper.get_ylabel()
    assert "[deg]" in lower.get_ylabel()
    assert "camera frame" in upper.get_title()


def test_exact_poses_can_be_drawn() -> None:
    _drawn(errors_by_range(np.array([10.0]), np.array([0.0]), np.array([0.0])))


def test_a_hold_stays_at_its_place_in_ric_and_its_cameras_look_at_the_target() -> None:
    figure = _drawn(trajectory_ric(hold(HoldConfig(position_m=(0.0, -30.0, 5.0), duration_s=60.0)), frustums=3))
    (axes,) = figure.axes
    path = np.array(axes.lines[0].get_data_3d())  # pyright: ignore[reportAttributeAccessIssue]
    np.testing.assert_allclose(path.T, np.tile([0.0, -30.0, 5.0], (path.shape[1], 1)), atol=1e-3)  # m
    pyramid = np.array(axes.collections[0]._segments3d)[:4]  # pyright: ignore[reportAttributeAccessIssue]
    looking = (pyramid[:, 1] - pyramid[:, 0]).mean(axis=0)
    toward = -np.array([0.0, -30.0, 5.0])
    cosine = looking @ toward / np.linalg.norm(looking) / np.linalg.norm(toward)
    assert cosine == pytest.approx(1.0, abs=1e-6)


def test_the_spiral_is_drawn_with_units_and_frame() -> None:
    (axes,) = _drawn(trajectory_ric(walking_safety_ellipse())).axes
    assert [axes.get_xlabel(), axes.get_ylabel()] == ["radial [m]", "in-track [m]"]
    assert "RIC" in axes.get_title()


def test_a_curve_skips_cells_that_are_empty(tmp_path: Path) -> None:
    path = tmp_path / "curve.csv"
    path.write_text("step,loss,validation\n10,3.0,\n20,2.0,\n20,,1.5\n30,1.0,\n")
    left, right = _drawn(learning_curve(path)).axes
    assert list(left.lines[0].get_xdata()) == [10, 20, 30]
    np.testing.assert_allclose(right.lines[0].get_xydata(), [[20, 1.5]])


@pytest.mark.parametrize(("text", "named"), [("a,b\n1,2\n", "step"), ("step,loss\n1,x\n", "column loss"), ("", "step")])
def test_a_curve_that_is_none_is_refused(tmp_path: Path, text: str, named: str) -> None:
    path = tmp_path / "curve.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=named):
        learning_curve(path)


def test_a_missing_curve_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nowhere\.csv"):
        learning_curve(tmp_path / "nowhere.csv")
