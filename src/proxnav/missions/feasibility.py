"""What a mission can see at best: pixels on the target, the Cramer-Rao bound, light and motion, by range."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera
from proxnav.missions.mission import Mission
from proxnav.pose.solve.best_accuracy import bound_at
from proxnav.records import SceneSpec
from proxnav.targets import Target

RANGES = 5
"""Rows of the table, from the least to the most range in equal ratios."""
EXPOSURE_S = 0.01
"""Time over which motion blur is given."""


@dataclass(frozen=True, slots=True)
class AtRange:
    """What is possible at one range, medians over random attitudes, each visible keypoint known to 1 px."""

    range_m: float
    target_px: float
    """Pixels across the target's bounding sphere."""
    lateral_m: float
    """Standard deviation of position across the line of sight, per axis."""
    depth_m: float
    """Standard deviation of position along it."""
    attitude_rad: float
    """Standard deviation of attitude, root of the sum of its three variances."""
    keypoints: float
    """Keypoints seen."""


@dataclass(frozen=True, slots=True)
class Feasibility:
    """What a mission can see."""

    rows: tuple[AtRange, ...]
    frames: int
    """Frames that the shares below are of."""
    umbra: float
    """Share of frames in Earth's shadow."""
    penumbra: float
    """Share of frames in its half-shadow."""
    cut: float
    """Share of frames in which the picture's edge cuts the target."""
    sun_from_axis_rad: float
    """Least angle between the camera's axis and the Sun in sunlit frames; NaN where there are none."""
    blur_px: float
    """Median motion of the target's origin over the image in `EXPOSURE_S`."""

    def text(self) -> str:
        """Both tables for people."""
        head = f"{'range [m]':>9}  {'target [px]':>11}  {'lateral [m]':>11}  {'depth [m]':>9}  {'attitude [deg]':>14}"
        lines = ["best possible accuracy (Cramer-Rao bound, visible keypoints known to 1 px):"]
        lines += [f"{head}  {'keypoints':>9}", *map(_row, self.rows), ""]
        blind = [row.range_m for row in self.rows if not np.isfinite(row.lateral_m)]
        if blind:
            lines[-1:] = [
                f"at {', '.join(f'{range_m:.3g}' for range_m in blind)} m most views show too few keypoints",
                "",
            ]
        sun = np.degrees(self.sun_from_axis_rad)
        closest = "" if np.isnan(sun) else f"; the Sun comes within {sun:.0f} deg of the camera's axis"
        dark = f"{100 * self.umbra:.0f} % in Earth's shadow, {100 * self.penumbra:.0f} % in its half-shadow"
        lines.append(f"{self.frames} frames: {dark}, {100 * self.cut:.0f} % cut by the picture's edge{closest}")
        lines.append(f"motion blur: {self.blur_px:.2f} px in {1e3 * EXPOSURE_S:.0f} ms of exposure (median)")
        return "\n".join(lines)


def feasibility(mission: Mission, target: Target, scenes: Sequence[SceneSpec]) -> Feasibility:
    """What is possible with the mission's camera at its ranges, and what its `scenes` are like."""
    ranges = np.geomspace(*mission.view.range_m, RANGES)
    lit = np.array([scene.sun.visible_fraction for scene in scenes])
    sun = [_sun_from_axis_rad(scene) for scene in scenes if scene.sun.visible_fraction > 0.0]
    return Feasibility(
        rows=tuple(_at(target, float(range_m), mission.camera) for range_m in ranges),
        frames=len(scenes),
        umbra=float((lit == 0.0).mean()),
        penumbra=float(((lit > 0.0) & (lit < 1.0)).mean()),
        cut=float(np.mean([_is_cut(scene, target) for scene in scenes])),
        sun_from_axis_rad=min(sun, default=float("nan")),
        blur_px=float(np.median([_speed_px(scene) for scene in scenes]) * EXPOSURE_S),
    )


def _row(row: AtRange) -> str:
    bound = f"{row.lateral_m:11.4f}  {row.depth_m:9.3f}  {np.degrees(row.attitude_rad):14.2f}"
    unknown = f"{'-':>11}  {'-':>9}  {'-':>14}"
    middle = bound if np.isfinite(row.lateral_m) else unknown
    return f"{row.range_m:9.1f}  {row.target_px:11.0f}  {middle}  {row.keypoints:9.1f}"


def _at(target: Target, range_m: float, camera: Camera) -> AtRange:
    lateral, depth, turn, seen = bound_at(target, range_m, camera)
    return AtRange(range_m, 2.0 * camera.fx * target.radius_m / range_m, lateral, depth, turn, seen)


def _sun_from_axis_rad(scene: SceneSpec) -> float:
    sun_cam = scene.T_cam_target.R @ np.array(scene.sun.direction_target)
    return float(np.arccos(np.clip(sun_cam[2], -1.0, 1.0)))


def _is_cut(scene: SceneSpec, target: Target) -> bool:
    pixels = scene.camera.project(scene.T_cam_target @ target.vertices_m)
    return not bool(scene.camera.contains(pixels).all())


def _speed_px(scene: SceneSpec) -> float:
    """Speed of the target's origin over the image [px/s], by a difference over a millisecond."""
    step_s, place = 1e-3, np.array(scene.t_cam_target_m)
    moved: Float[np.ndarray, "2 3"] = np.stack([place, place + step_s * np.array(scene.exposure.v_cam_target_mps)])
    before, after = scene.camera.project(moved)
    return float(np.linalg.norm(after - before) / step_s)
