"""Labels held against themselves: the target's points, carried into the image by each pose, must fall on the pixels.

Where they do not, the usual misreadings are tried one by one, and the refusal names the one that explains the pixels.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from proxnav.datasets.formats.attitude import Order
from proxnav.datasets.formats.labels import LabelRecord, Labels
from proxnav.datasets.formats.point_recovery import recovered
from proxnav.errors import InputError
from proxnav.geometry import Camera, quaternion
from proxnav.geometry.types import Points
from proxnav.records import NOT_IN_IMAGE

_TYPICAL, _TYPICAL_PX = 0.02, 2.0
"""Typical miss of a set, in parts of the target's extent in the image and in pixels, that noise explains."""
_SINGLE, _SINGLE_PX = 0.05, 5.0
"""The same of a single image."""
_EXPLAINED = 0.25
"""A reading explains the pixels where it leaves less than this part of the miss."""
_UNITS = {"mm": 1e-3, "cm": 1e-2, "inches": 0.0254, "feet": 0.3048}


@dataclass(frozen=True, slots=True, eq=False)
class Observed:
    """Poses and pixels of n images of one target."""

    camera: Camera
    points_m: Points | None
    """Points of the target; None where they are found from the pixels themselves."""
    q_wxyz: Float[np.ndarray, "n wxyz=4"]
    t_m: Float[np.ndarray, "n 3"]
    pixels: Float[np.ndarray, "n k 2"]
    """NaN where a point is not labelled."""

    def miss(self) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
        """Mean distance of each image's labelled points from the projected ones: in pixels, and in parts of the extent
        of the labelled ones. Infinite where the pose shows none of them.
        """
        R = quaternion.to_matrix(self.q_wxyz)
        points = recovered(self.camera, R, self.t_m, self.pixels) if self.points_m is None else self.points_m
        if points is None:
            return np.full(len(R), np.nan), np.full(len(R), np.nan)
        apart = np.linalg.norm(_projected(self, points) - self.pixels, axis=2)
        known = np.asarray(np.isfinite(self.pixels).all(axis=2))
        seen = known & np.isfinite(apart)
        half = seen.sum(axis=1) * 2 >= known.sum(axis=1)
        mean = np.where(seen, apart, 0.0).sum(axis=1) / np.maximum(seen.sum(axis=1), 1)
        px = np.where(half & seen.any(axis=1), mean, np.inf)
        return px, px / _extent(self.pixels, known)


Reading = Callable[[Observed], Observed]


def check_consistency(labels: Labels, order: Order | None, source: str) -> None:
    """InputError where keypoints and poses of labels contradict each other; `order` is that of the quaternions.

    Nothing is compared where poses, pixels or the camera are missing.
    """
    records = [r for r in labels.records if r.T_cam_target is not None and np.isfinite(_labelled(r)).any()]
    if labels.camera is None or not records:
        return
    _check_counts(records, labels.keypoints_m, source)
    observed = _observed(records, labels.camera, labels.keypoints_m)
    px, share = observed.miss()
    if np.isnan(px).all():  # no 3-D points, and too few images to find them
        return
    typical = float(np.median(share))
    if typical > _TYPICAL:
        _refuse_explained(observed, typical, order, source)
        if float(np.median(px)) > _TYPICAL_PX:
            raise InputError(
                f"{source}: the keypoints miss the projection of their poses {_by(float(np.median(px)))} in the "
                f"median image, {_percent(typical)} of the target's extent; check camera, target, units and the order "
                "of the points"
            )
    _refuse_single(records, px, share, source)


def _observed(records: Sequence[LabelRecord], camera: Camera, points_m: Points | None) -> Observed:
    poses = [r.T_cam_target for r in records if r.T_cam_target is not None]
    pixels = np.array([_labelled(record) for record in records])
    q, t = np.array([T.q_wxyz for T in poses]), np.array([T.t_m for T in poses])
    return Observed(camera, points_m, q, t, pixels)


def _labelled(record: LabelRecord) -> Float[np.ndarray, "k 2"]:
    """Pixels of the points that the file says are in the image, NaN for the others."""
    if record.keypoints_px is None:
        return np.empty((0, 2))
    if record.visibility is None:
        return np.where(np.isfinite(record.keypoints_px).all(axis=1, keepdims=True), record.keypoints_px, np.nan)
    return np.where((record.visibility != NOT_IN_IMAGE)[:, None], record.keypoints_px, np.nan)


def _check_counts(records: Sequence[LabelRecord], points_m: Points | None, source: str) -> None:
    counts = {len(r.keypoints_px): r.filename for r in records if r.keypoints_px is not None}
    if points_m is not None and set(counts) != {len(points_m)}:
        other = next(count for count in counts if count != len(points_m))
        raise InputError(
            f"{source}: '{counts[other]}' has {other} keypoints and the target {len(points_m)}; give the --target that "
            "the labels were made of"
        )
    if len(counts) > 1:
        raise InputError(
            f"{source}: images have {' and '.join(map(str, sorted(counts)))} keypoints; one target has one"
        )


def _refuse_explained(observed: Observed, typical: float, order: Order | None, source: str) -> None:
    """InputError with the misreading that explains the pixels, where one does."""
    best, advice = np.inf, ""
    for said, reading in _readings(order, observed.camera):
        px, share = reading(observed).miss()
        left = float(np.median(share))
        if left < _EXPLAINED * min(best, typical) and (left < _TYPICAL or float(np.median(px)) < _TYPICAL_PX):
            best, advice = left, said
    if advice:
        shown = f"read as {order}, the quaternions" if "quaternion" in advice else "the projected points"
        raise InputError(
            f"{source}: {shown} miss the labelled points by {_percent(typical)} of the target's extent; they fit to "
            f"{best:.1%} when {advice}"
        )


def _refuse_single(
    records: Sequence[LabelRecord], px: Float[np.ndarray, "n"], share: Float[np.ndarray, "n"], source: str
) -> None:
    bad = np.flatnonzero((share > _SINGLE) & (px > _SINGLE_PX))
    if bad.size:
        first = bad[0]
        raise InputError(
            f"{source}: keypoints of {bad.size} of {len(records)} images contradict their poses, first "
            f"'{records[first].filename}' {_by(float(px[first]))}; mend or leave out these labels"
        )


def _readings(order: Order | None, camera: Camera) -> list[tuple[str, Reading]]:
    """(what to say, what to do) of the usual misreadings."""
    size = np.array([camera.width, camera.height], dtype=np.float64)
    return [*_of_quaternions(order), *_of_positions(), *_of_pixels(size)]


def _of_quaternions(order: Order | None) -> list[tuple[str, Reading]]:
    other, step = ("xyzw", 1) if order == "wxyz" else ("wxyz", -1)
    found: list[tuple[str, Reading]] = [
        (
            "the quaternions are inverted (or the matrices transposed): they map camera to target; invert them before "
            "use",
            lambda o: replace(o, q_wxyz=quaternion.conjugate(o.q_wxyz)),
        ),
        ("the whole poses are inverted: these are T_target_cam, invert each quaternion and position", _inverted),
        (
            "the camera's y and z axes are turned: the quaternions and positions are those of OpenGL or Blender "
            "(y up, z back), not of OpenCV",
            _turned_axes,
        ),
    ]
    if order is not None:
        advice = f"the quaternions are read as {other}: give --quaternion-order {other}"
        found.insert(0, (advice, lambda o: replace(o, q_wxyz=np.roll(o.q_wxyz, step, axis=1))))
    return found


def _of_positions() -> list[tuple[str, Reading]]:
    def scaled(factor: float) -> Reading:
        return lambda o: replace(o, t_m=o.t_m * factor)

    found = [(f"the positions are in {unit}: give them in metres", scaled(metres)) for unit, metres in _UNITS.items()]
    found += [
        (f"the target's points are in {unit}: give them in metres", scaled(1.0 / m)) for unit, m in _UNITS.items()
    ]
    found.append(("the sign of the positions is reversed", scaled(-1.0)))
    return [*found, ("positions, target or focal length are of another scale than the pixels", _rescaled)]


def _of_pixels(size: Float[np.ndarray, "2"]) -> list[tuple[str, Reading]]:
    def moved(change: Callable[[Float[np.ndarray, "n k 2"]], Float[np.ndarray, "n k 2"]]) -> Reading:
        return lambda o: replace(o, pixels=change(o.pixels))

    mirror_x, mirror_y = np.array([-1.0, 1.0]), np.array([1.0, -1.0])
    return [
        ("the keypoints are parts of the image's size, 0 to 1: scale them to pixels", moved(lambda p: p * size)),
        ("the keypoints' x and y are exchanged", moved(lambda p: p[..., ::-1])),
        ("the keypoints' x counts from the right", moved(lambda p: p * mirror_x + size * (1.0, 0.0))),
        ("the keypoints' y counts from the bottom", moved(lambda p: p * mirror_y + size * (0.0, 1.0))),
        ("the keypoints' order is reversed", moved(lambda p: p[:, ::-1])),
        ("the keypoints are those of the image at another size than the camera's", _resized),
        ("the keypoints are pixels of a crop: shift and scale them to the full image", _cropped),
    ]  # fmt: skip


def _inverted(o: Observed) -> Observed:
    q = quaternion.conjugate(o.q_wxyz)
    R = quaternion.to_matrix(q)
    return replace(o, q_wxyz=q, t_m=-np.einsum("nij,nj->ni", R, o.t_m))


def _turned_axes(o: Observed) -> Observed:
    half_turn = np.broadcast_to(np.array([0.0, 1.0, 0.0, 0.0]), o.q_wxyz.shape)
    return replace(o, q_wxyz=quaternion.multiply(half_turn, o.q_wxyz), t_m=o.t_m * (1.0, -1.0, -1.0))


def _rescaled(o: Observed) -> Observed:
    """Positions by the one factor that makes the target as large as it is labelled."""
    known, factor = np.asarray(np.isfinite(o.pixels).all(axis=2)), 1.0
    if o.points_m is None:
        return o
    for _ in range(3):  # nearly inverse to the range; exact for a flat target
        projected = _projected(replace(o, t_m=o.t_m * factor), o.points_m)
        seen = known & np.asarray(np.isfinite(projected).all(axis=2))
        factor *= float(np.median(_extent(projected, seen) / _extent(o.pixels, seen)))
    return replace(o, t_m=o.t_m * factor)


def _projected(o: Observed, points_m: Points) -> Float[np.ndarray, "n k 2"]:
    R = quaternion.to_matrix(o.q_wxyz)
    return o.camera.project(points_m[None] @ np.swapaxes(R, 1, 2) + o.t_m[:, None])


def _resized(o: Observed) -> Observed:
    """Pixels by the one factor that fits all images best."""
    if o.points_m is None:
        return o
    projected = _projected(o, o.points_m)
    known = np.isfinite(projected) & np.isfinite(o.pixels)
    a, b = np.where(known, o.pixels, 0.0), np.where(known, projected, 0.0)
    return replace(o, pixels=o.pixels * ((a * b).sum() / max((a * a).sum(), 1e-300)))


def _cropped(o: Observed) -> Observed:
    """Pixels shifted and scaled in each image so that they fit best."""
    if o.points_m is None:
        return o
    projected = _projected(o, o.points_m)
    known = np.asarray((np.isfinite(projected) & np.isfinite(o.pixels)).all(axis=2, keepdims=True))
    count = np.maximum(known.sum(axis=1, keepdims=True), 1)
    a, b = (np.where(known, x, 0.0) for x in (o.pixels, projected))
    a0, b0 = a.sum(axis=1, keepdims=True) / count, b.sum(axis=1, keepdims=True) / count
    a, b = np.where(known, a - a0, 0.0), np.where(known, b - b0, 0.0)
    scale = (a * b).sum(axis=(1, 2), keepdims=True) / np.maximum((a * a).sum(axis=(1, 2), keepdims=True), 1e-300)
    scale = np.maximum(scale, 0.0)
    return replace(o, pixels=(o.pixels - a0) * scale + b0)


def _extent(pixels: Float[np.ndarray, "n k 2"], known: Bool[np.ndarray, "n k"]) -> Float[np.ndarray, "n"]:
    """Diagonal of the box of the labelled points [px], 1 px at least."""
    low = np.where(known[..., None], pixels, np.inf).min(axis=1)
    high = np.where(known[..., None], pixels, -np.inf).max(axis=1)
    return np.maximum(np.nan_to_num(np.linalg.norm(high - low, axis=1), posinf=1.0), 1.0)


def _by(px: float) -> str:
    return f"by {px:.3g} px" if np.isfinite(px) else "because the camera does not see the target there"


def _percent(share: float) -> str:
    return f"{share:.0%}" if np.isfinite(share) else "all"
