"""Quaternions of files: their order is the format's, and where boxes alone can tell, it is checked by them."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from proxnav.datasets.formats.labels import LabelRecord, Labels
from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.geometry.boxes import box_of_points, cut_at_edges
from proxnav.geometry.types import Points

Order = Literal["wxyz", "xyzw"]

_FRAMES = 50  # more say the same
_CLEARLY = 0.25  # another order must leave less than this part of the residual to be called the right one
_GOOD = 0.02  # residual that needs no explanation, in parts of the target's size in the image


@dataclass(frozen=True, slots=True)
class _Reading:
    """One way to understand four numbers that were read as wxyz."""

    name: str
    advice: str

    def __call__(self, q: Float[np.ndarray, "wxyz=4"], order: Order) -> Float[np.ndarray, "wxyz=4"]:
        if self.name == "other order":
            return np.roll(q, 1) if order == "wxyz" else np.roll(q, -1)
        return quaternion.conjugate(q)


def pose(q: Float[np.ndarray, "4"], t_m: Float[np.ndarray, "3"], order: Order, where: str) -> Pose:
    """T_cam_target of four numbers in `order` and a position [m]; InputError unless the quaternion is unit."""
    norm = np.linalg.norm(q)
    if not abs(norm - 1.0) < 1e-4:
        raise InputError(f"{where}: expected a unit quaternion ({order}), found norm {norm:.6g}")
    return Pose.from_wxyz("cam", "target", np.roll(q, 1) if order == "xyzw" else q, t_m)


def check_order(labels: Labels, order: Order, source: str) -> None:
    """InputError where boxes fit another order or direction of the quaternions, and do not fit this.

    The residual is the distance from the box of the projected points to the labelled one, in parts of the target's
    size. Keypoints say more: `consistency` compares with them.
    """
    camera, points_m = labels.camera, labels.keypoints_m
    usable = [r for r in labels.records if r.T_cam_target is not None and _has_box_alone(r)][:_FRAMES]
    if camera is None or points_m is None or not usable:
        return
    now = _residual(usable, points_m, camera, None, order)
    other = "xyzw" if order == "wxyz" else "wxyz"
    readings = (
        _Reading("other order", f"as {other}: give --quaternion-order {other}"),
        _Reading("inverse", "inverted: they map camera to target; invert them before use"),
    )
    left = [_residual(usable, points_m, camera, reading, order) for reading in readings]
    best = int(np.argmin(left))
    if now > _GOOD and left[best] < _CLEARLY * now:
        raise InputError(
            f"{source}: read as {order}, the quaternions miss the labelled boxes by {now:.0%} of the target's size; "
            f"they fit to {left[best]:.1%} when read {readings[best].advice}"
        )


def _has_box_alone(record: LabelRecord) -> bool:
    return record.box_xyxy is not None and record.keypoints_px is None


def _residual(
    records: list[LabelRecord], points_m: Points, camera: Camera, reading: _Reading | None, order: Order
) -> float:
    return float(np.median([_miss(record, points_m, camera, reading, order) for record in records]))


def _miss(record: LabelRecord, points_m: Points, camera: Camera, reading: _Reading | None, order: Order) -> float:
    T = record.T_cam_target
    if T is None:
        return np.inf
    if reading is not None:
        T = Pose.from_wxyz("cam", "target", reading(T.q_wxyz, order), T.t_m)
    projected = camera.project(T @ points_m)
    size = np.linalg.norm(np.ptp(points_m, axis=0)) * camera.fx / np.linalg.norm(T.t_m)
    if record.box_xyxy is None or not np.isfinite(projected).all():
        return np.inf
    box = cut_at_edges(box_of_points(projected), camera)
    return float(np.abs(box - record.box_xyxy).mean() / size)
