"""Figures of a run; each function returns one Figure, which the caller saves. No global state of matplotlib is used.

>>> figure = errors_by_range(np.array([10.0, 50.0]), np.array([0.1, 0.4]), np.array([0.01, 0.02]))
>>> figure.axes[0].get_ylabel()
'position error E_T [m]'
"""

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.pose_errors import HALF_TURN_RAD
from proxnav.geometry.relative_motion import ric_from_eci
from proxnav.geometry.types import Rotation3x3, Vector3
from proxnav.records import Trajectory
from proxnav.viewing.charts import running_median

_POINTS, _LINE, _WRONG = "#0b5cad", "#b45309", "#b3261e"


def errors_by_range(
    range_m: Float[np.ndarray, "n"], e_t_m: Float[np.ndarray, "n"], e_r_rad: Float[np.ndarray, "n"]
) -> Figure:
    """Position error (norm) and attitude error of n poses against the true range; half turns are red triangles."""
    figure = Figure(figsize=(7.0, 7.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    wrong = e_r_rad > HALF_TURN_RAD
    for axes, values in ((upper, e_t_m), (lower, np.degrees(e_r_rad))):
        axes.plot(range_m[~wrong], values[~wrong], ".", color=_POINTS, alpha=0.6, label="pose")
        if wrong.any():
            axes.plot(range_m[wrong], values[wrong], "^", color=_WRONG, markersize=5, label="half turn (E_R > 90 deg)")
        line = running_median(list(range_m), list(values))
        if line:
            axes.plot(*np.array(line).T, color=_LINE, linewidth=2, label="running median")
        axes.set_yscale("log" if np.any(values > 0) else "linear")
        axes.grid(alpha=0.4)
    upper.set(title="Errors of T_cam_target, camera frame", ylabel="position error E_T [m]")
    lower.set(xlabel="true range [m]", ylabel="attitude error E_R [deg]")
    upper.legend()
    return figure


def trajectory_ric(trajectory: Trajectory, frustums: int = 12, half_angle_rad: float = 0.35) -> Figure:
    """Path of the camera about the target in RIC axes (x radial out, y in-track, z cross-track).

    `frustums` cameras spread over the time are drawn as pyramids of the given half angle, looking where they look.
    """
    rho_m, axes_ric = _camera_in_ric(trajectory)
    figure = Figure(figsize=(8.0, 6.5), layout="constrained")
    axes = figure.add_subplot(projection="3d")
    axes.plot(*rho_m.T, color=_POINTS, linewidth=1.2, label="camera")
    axes.plot(*np.zeros((3, 1)), "o", color=_WRONG, label="target")
    axes.plot(*rho_m[:1].T, "s", color=_LINE, label="start")
    size = 0.12 * float(np.linalg.norm(rho_m, axis=1).max())
    chosen = np.unique(np.linspace(0, len(rho_m) - 1, min(frustums, len(rho_m))).round().astype(int))
    lines = [line for k in chosen for line in _frustum(rho_m[k], axes_ric[k], size, half_angle_rad)]
    axes.add_collection3d(Line3DCollection(lines, colors=_LINE, linewidths=0.8))
    axes.set(xlabel="radial [m]", ylabel="in-track [m]", zlabel="cross-track [m]")
    axes.yaxis.labelpad = 14
    axes.view_init(elev=28, azim=-28)
    axes.set_title(f"Camera about the target, RIC frame, {trajectory.t[-1] - trajectory.t[0]:.0f} s")
    _equal_scales(axes, np.vstack([rho_m, np.zeros(3)]))
    axes.legend()
    return figure


def learning_curve(path: Path) -> Figure:
    """Loss and validation over the steps of a training, from its curve.csv; empty cells are rows of the other kind."""
    columns = _columns(path)
    figure = Figure(figsize=(7.0, 4.5), layout="constrained")
    axes = figure.add_subplot()
    axes.set(title=f"Training, {path.parent.name}", xlabel="step [-]", ylabel="loss [-]")
    _curve(axes, columns["step"], columns["loss"], _POINTS, "loss")
    if "validation" in columns:
        right = axes.twinx()
        right.set_ylabel("validation score [-], lower is better", color=_LINE)
        _curve(right, columns["step"], columns["validation"], _LINE, "validation", ".-")
    axes.grid(alpha=0.4)
    return figure


def _camera_in_ric(trajectory: Trajectory) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3 3"]]:
    """Camera positions in RIC [m] and camera axes as columns in RIC."""
    target = trajectory.r_eci_target_m, trajectory.v_eci_target_mps
    rho_m, _ = ric_from_eci(*target, trajectory.r_eci_chaser_m, trajectory.v_eci_chaser_mps)
    axes_eci = quaternion.to_matrix(trajectory.q_eci_cam)
    # a direction in RIC is the difference of two places in RIC
    ends = [trajectory.r_eci_chaser_m + axes_eci[:, :, k] for k in range(3)]
    axes = [ric_from_eci(*target, end, trajectory.v_eci_chaser_mps)[0] - rho_m for end in ends]
    return rho_m, np.stack(axes, axis=-1)


def _frustum(
    apex: Vector3, R_ric_cam: Rotation3x3, size: float, half_angle_rad: float
) -> list[Float[np.ndarray, "2 3"]]:
    """Edges of the pyramid that a camera at `apex` sees, as lines in RIC [m]."""
    reach = np.tan(half_angle_rad)
    corners_cam = size * np.array([[-reach, -reach, 1], [reach, -reach, 1], [reach, reach, 1], [-reach, reach, 1]])
    corners = apex + corners_cam @ R_ric_cam.T
    sides = [np.stack([apex, corner]) for corner in corners]
    return sides + [np.stack([corners[k], corners[(k + 1) % 4]]) for k in range(4)]


def _equal_scales(axes: Axes, points: Float[np.ndarray, "n 3"]) -> None:
    """One metre has the same length on all three axes."""
    low, high = points.min(axis=0), points.max(axis=0)
    extent = np.maximum(high - low, 0.3 * float((high - low).max()) + 1e-9)
    middle = (low + high) / 2
    for name, m, half in zip("xyz", middle, 0.55 * extent, strict=True):
        getattr(axes, f"set_{name}lim")(m - half, m + half)
        ticks = max(2, round(8 * half / (0.55 * extent.max())))  # short axes have room for few
        getattr(axes, f"{name}axis").set_major_locator(MaxNLocator(ticks))
    axes.set_box_aspect(tuple(extent))  # pyright: ignore[reportArgumentType]


def _curve(
    axes: Axes, x: Float[np.ndarray, "n"], y: Float[np.ndarray, "n"], colour: str, label: str, style: str = "-"
) -> None:
    known = np.isfinite(y)
    axes.plot(x[known], y[known], style, color=colour, label=label)
    if known.any() and y[known].min() > 0:
        axes.set_yscale("log")


def _columns(path: Path) -> dict[str, Float[np.ndarray, "n"]]:
    """Columns of a curve.csv as numbers, NaN where a cell is empty; InputError names what is wrong."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}; expected the curve.csv of a training") from None
    if not rows or not {"step", "loss"} <= set(rows[0]):
        raise InputError(f"{path}: expected a csv with the columns step and loss and at least one row")
    return {name: _numbers([row[name] for row in rows], f"{path}, column {name}") for name in rows[0] if name}


def _numbers(cells: Sequence[str | None], where: str) -> Float[np.ndarray, "n"]:
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError as error:
        raise InputError(f"{where}: {error}; expected numbers") from None


def errors_in_3_sigma(
    t: Float[np.ndarray, "n"], errors: Float[np.ndarray, "n 12"], sigmas: Float[np.ndarray, "n 12"]
) -> Figure:
    """Errors of a navigation solution over time, position, velocity, attitude and rate, within three sigma."""
    figure = Figure(figsize=(11.0, 9.0), layout="constrained")
    grid = figure.subplots(4, 3, sharex=True, sharey="row")
    turn = np.degrees(1.0)
    rows = (
        ("position [m], RIC", 1.0), ("velocity [mm/s], RIC", 1e3), ("attitude [deg], target axes", turn),
        ("rate [mdeg/s], target axes", 1e3 * turn),
    )  # fmt: skip
    for i, (label, unit) in enumerate(rows):
        bound = 3.0 * unit * sigmas[:, 3 * i : 3 * i + 3]
        for j in range(3):
            axes = grid[i, j]
            axes.fill_between(t, -bound[:, j], bound[:, j], color=_LINE, alpha=0.2, linewidth=0, label="3 sigma")
            axes.plot(t, unit * errors[:, 3 * i + j], color=_POINTS, linewidth=1.0, label="error")
            axes.grid(alpha=0.4)
        settled = bound[len(bound) // 4 :]
        largest = unit * np.abs(errors[len(bound) // 4 :, 3 * i : 3 * i + 3])
        most = 1.3 * max(float(np.nanmax(settled)), float(np.nanmax(largest)))
        grid[i, 0].set(ylabel=label, ylim=(-most, most))
    for axes, name in zip(grid[0], "xyz", strict=True):
        axes.set_title(f"{name}: truth minus estimate")
    for axes in grid[-1]:
        axes.set_xlabel("time [s]")
    grid[0, 0].legend(loc="upper right")
    return figure
