"""Keypoints for a mesh that nobody has annotated: sharp, often visible, far apart; and the symmetries to beware of."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

from proxnav.errors import InputError
from proxnav.targets.keypoints.corners import corner_turn, sharpness
from proxnav.targets.keypoints.spread import farthest_points
from proxnav.targets.keypoints.visibility import first_hits, surface_samples
from proxnav.targets.target import Target

MIN_SHARPNESS = 0.15
"""1 - length of the mean normal about a vertex: 0 flat, 0.29 a right-angled edge, 0.42 a cube's corner."""
MIN_TURN = 1e-5
"""Least variance of the normals about a corner out of the plane of its edge: 0 on flats and along straight edges,
where a point can slide without being noticed; a rim of 128 facets has 3e-4."""
MIN_SEEN = 0.25
"""Share of all directions from which a point must be visible."""
MAX_CANDIDATES = 1500
FEWEST, MOST = 4, 200
N_DIRECTIONS = 96


def suggest_keypoints(target: Target, count: int = 24) -> tuple[Float[np.ndarray, "k 3"], tuple[str, ...]]:
    """Up to `count` corners, seen from a quarter of all directions, and spread over the craft; all where it has fewer.

    The first is the one farthest from the middle; each further one is the farthest from those before it.
    """
    if not FEWEST <= count <= MOST:
        raise InputError(f"{count} keypoints asked for; a pose needs at least {FEWEST}, a network takes at most {MOST}")
    points = _candidates(target, count)
    if len(points) < FEWEST:
        raise InputError(
            f"target {target.name}: only {len(points)} distinct corners that are often seen, a pose needs {FEWEST}; "
            "name the points yourself with --keypoints"
        )
    first = int(np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1)))
    chosen = points[farthest_points(points, count, first)]
    return chosen, tuple(f"p{i:02d}" for i in range(len(chosen)))


def directions(n: int) -> Float[np.ndarray, "n 3"]:
    """Fibonacci lattice: n unit vectors spread evenly over the sphere."""
    z = 1.0 - (2.0 * np.arange(n) + 1.0) / n
    a = np.arange(n) * np.pi * (3.0 - np.sqrt(5.0))
    r = np.sqrt(1.0 - z**2)
    return np.stack([r * np.cos(a), r * np.sin(a), z], axis=1)


def seen_share(target: Target, points_m: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n"]:
    """Share of all directions from which each point is visible, up to 1 % of the target's radius."""
    d = directions(N_DIRECTIONS)
    origin = points_m[:, None, :] + 0.01 * target.size_m * d[None]
    hit = first_hits(target, origin.reshape(-1, 3), np.tile(d, (len(points_m), 1)))
    return np.isinf(hit).reshape(len(points_m), len(d)).mean(axis=1)


def _candidates(target: Target, count: int) -> Float[np.ndarray, "n 3"]:
    """Corners, at most one in each cell of a grid, sharp and often seen; both are eased where they leave too few."""
    merged, index = np.unique(np.round(target.vertices_m / 1e-6), axis=0, return_inverse=True)
    points, faces = merged * 1e-6, index.reshape(-1)[target.faces]
    corner = np.flatnonzero(corner_turn(points, faces) >= MIN_TURN)
    score, points = sharpness(points, faces)[corner], points[corner]
    if len(points) == 0:
        return points
    thin = _thinned(points, score, target.size_m / 40)
    points, score = points[thin], score[thin]
    seen = seen_share(target, points)
    good = (score >= MIN_SHARPNESS) & (seen >= MIN_SEEN)
    return points[good] if int(good.sum()) >= 2 * count else points[seen >= MIN_SEEN / 2]


def _thinned(points: Float[np.ndarray, "n 3"], score: Float[np.ndarray, "n"], cell_m: float) -> Int[np.ndarray, "m"]:
    """Indices of the sharpest vertex of each cell, at most MAX_CANDIDATES; order does not depend on the file's."""
    cell = np.floor(points / cell_m).astype(np.int64)
    order = np.lexsort((*points.T, -score.round(6)))
    _, first = np.unique(cell[order], axis=0, return_index=True)
    kept = order[np.sort(first)]
    return kept if len(kept) <= MAX_CANDIDATES else _thinned(points, score, 1.4 * cell_m)


@dataclass(frozen=True, slots=True, eq=False)
class Symmetry:
    """A turn that brings the shape nearly back onto itself."""

    axis: str
    angle_deg: float
    gap: float
    """95th percentile of the distance between the turned surface and the surface, as a share of the radius."""
    R: Float[np.ndarray, "3 3"]
    """With `t_m` the turn as p -> R p + t in the target frame."""
    t_m: Float[np.ndarray, "3"]


def near_symmetries(target: Target, rng: np.random.Generator, limit: float = 0.09) -> list[Symmetry]:
    """Half and quarter turns about the principal axes through the surface's centre that leave it nearly unchanged.

    Shape only: materials may still tell the poses apart. Such turns are where a keypoint network confuses poses.
    """
    cloud = surface_samples(target, 6000, rng)
    centre = cloud.mean(axis=0)
    _, _, axes = np.linalg.svd(cloud - centre, full_matrices=False)
    tree, probe = KDTree(cloud), cloud[:1000]
    found = []
    for name, axis in zip(("long", "middle", "short"), axes, strict=True):
        for angle in (180.0, 90.0):
            R = Rotation.from_rotvec(np.radians(angle) * axis).as_matrix()
            t_m = centre - R @ centre
            distance = tree.query(probe @ R.T + t_m)[0]
            gap = float(np.percentile(distance, 95)) / target.size_m
            if gap < limit:
                found.append(Symmetry(f"{name} axis {np.round(axis, 2).tolist()}", angle, gap, R, t_m))
    return found
