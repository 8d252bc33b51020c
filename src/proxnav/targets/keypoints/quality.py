"""Whether keypoints can carry a pose: spread over the craft, out of one plane, seen from all sides, not mistaken."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float

from proxnav.targets.keypoints.choice import Symmetry, seen_share
from proxnav.targets.target import Target

FLAT = 0.08
"""Least over largest standard deviation of the points along their principal axes: below it they nearly fill a plane."""
NARROW = 0.5
"""Extent of the points over that of the mesh, along the mesh's longest axis: below it they miss much of the craft."""
RARELY = 0.15
"""Share of directions from which a point is seen, below which it will rarely help."""


def flatness(points_m: Float[np.ndarray, "k 3"]) -> float:
    """Least over largest standard deviation along the principal axes: 0 in a plane, 1 for a ball.

    >>> flatness(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]))
    0.0
    """
    spread = np.linalg.svd(points_m - points_m.mean(axis=0), compute_uv=False)
    return float(spread[2] / max(spread[0], 1e-300))


def complaints(target: Target) -> Iterator[str]:
    """One sentence for each weakness of the target's keypoints."""
    points = target.keypoints_m
    flat = flatness(points)
    if flat < FLAT:
        yield (
            f"the keypoints lie nearly in a plane (thickness {flat:.1%} of their spread): seen along it, a pose and "
            "its mirror image look alike; add points off that plane with --keypoints"
        )
    for name, index in target.subsets.items():
        if flat >= FLAT and (thin := flatness(points[list(index)])) < FLAT:
            yield f"the subset '{name}' lies nearly in a plane (thickness {thin:.1%} of its spread)"
    extent, whole = np.ptp(points, axis=0), np.ptp(target.vertices_m, axis=0)
    axis = int(np.argmax(whole))
    if extent[axis] < NARROW * whole[axis]:
        yield (
            f"the keypoints span {extent[axis]:.2f} m of {whole[axis]:.2f} m along the longest axis: depth and "
            "attitude suffer in proportion; choose points nearer the ends"
        )
    inside = _far_from_surface(target)
    if inside:
        yield f"not on the mesh: {', '.join(inside)}; keypoints and mesh may differ in frame or unit"
    seen = seen_share(target, points)
    rare = [name for name, share in zip(target.keypoint_names, seen, strict=True) if share < RARELY]
    if rare:
        yield f"seen from less than {RARELY:.0%} of all directions: {', '.join(rare)}"


def mistaken(target: Target, turn: Symmetry) -> list[str]:
    """Keypoints that such a turn brings near another one, as 'a~b'."""
    moved = target.keypoints_m @ turn.R.T + turn.t_m
    gap = np.linalg.norm(moved[:, None] - target.keypoints_m[None], axis=2)
    names, near = target.keypoint_names, np.argmin(gap, axis=1)
    close = gap[np.arange(len(near)), near] < 0.1 * target.size_m
    pairs = {tuple(sorted((i, int(near[i])))) for i in np.flatnonzero(close) if near[i] != i}
    return [f"{names[a]}~{names[b]}" for a, b in sorted(pairs)]


def _far_from_surface(target: Target) -> list[str]:
    """Names of points farther from every vertex and triangle middle than a tenth of the radius."""
    from scipy.spatial import KDTree

    corners = target.vertices_m[target.faces]
    surface = np.concatenate([target.vertices_m, corners.mean(axis=1), 0.5 * (corners[:, 0] + corners[:, 1])])
    gap = KDTree(surface).query(target.keypoints_m)[0]
    return [name for name, d in zip(target.keypoint_names, gap, strict=True) if d > 0.15 * target.size_m]
