"""Meshes that are finer than any camera sees, by fewer triangles, with a measured bound on what that moves.

Quadric error metrics: M. Garland, P. Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import fast_simplification
import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import KDTree

from proxnav.targets.cad.image_tile import Picture
from proxnav.targets.cad.mesh_part import MeshPart
from proxnav.targets.cad.welding import welded

MOST_TRIANGLES = 150_000
FINEST = 4
"""How many times that number is spent where the bound asks for it."""
MOST_PX = 0.25
"""What the outline may move at the nearest range [px] before more triangles are kept."""
N_PROBES = 60_000
N_SAMPLES = 600_000
Triangles = Float[np.ndarray, "_n corner=3 3"]


def decimated(parts: Sequence[MeshPart], pixel_m: float, say: Callable[[str], None]) -> list[MeshPart]:
    """The parts with at most MOST_TRIANGLES together, FINEST times as many where they would move by more than MOST_PX.

    `pixel_m` is what a pixel covers at the nearest range. The bound is the largest distance of points of either surface
    from the other: no outline moves by more.
    """
    total = sum(len(part.faces) for part in parts)
    if total <= MOST_TRIANGLES:
        return list(parts)
    most = MOST_TRIANGLES
    while True:
        say(f"decimating {total} triangles to {most}")
        kept = [_fewer(part, most / total) for part in parts]
        gap = surface_gap(_triangles(parts), _triangles(kept))
        if gap <= MOST_PX * pixel_m or 2 * most > min(FINEST * MOST_TRIANGLES, total):
            break
        most *= 2
    count = sum(len(part.faces) for part in kept)
    say(
        f"decimated {total} triangles to {count}: no surface moves by more than {1e3 * gap:.3g} mm "
        f"({gap / pixel_m:.2g} px at the nearest range)"
    )
    return kept


def surface_gap(a: Triangles, b: Triangles) -> float:
    """Largest distance [m] of points on either surface from the other, over N_PROBES random points of each."""
    rng = np.random.default_rng(0)
    return max(_one_way(a, b, rng), _one_way(b, a, rng))


def _one_way(probed: Triangles, other: Triangles, rng: np.random.Generator) -> float:
    """Distances to the triangles of the samples that are nearest: never less than the true ones."""
    from trimesh.triangles import closest_point

    probes = np.concatenate([_samples(probed, N_PROBES // 2, rng)[0], _corners(probed, N_PROBES // 2, rng)])
    samples, owner = _samples(other, N_SAMPLES, rng)
    near = np.asarray(KDTree(samples).query(probes, k=4)[1])
    nearest = np.full(len(probes), np.inf)
    for candidate in near.T:
        point = closest_point(other[owner[candidate]], probes)
        nearest = np.minimum(nearest, np.linalg.norm(point - probes, axis=1))
    return float(nearest.max())


def _samples(
    triangles: Triangles, count: int, rng: np.random.Generator
) -> tuple[Float[np.ndarray, "k 3"], Int[np.ndarray, "k"]]:
    """(points spread evenly over the surface, index of the triangle of each)."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    place = (np.arange(count) + rng.random(count)) / count * area.sum()
    owner = np.minimum(np.searchsorted(np.cumsum(area), place), len(triangles) - 1)
    u, v = rng.random((2, count, 1))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    return a[owner] + u * (b - a)[owner] + v * (c - a)[owner], owner


def _corners(triangles: Triangles, count: int, rng: np.random.Generator) -> Float[np.ndarray, "k 3"]:
    corners = triangles.reshape(-1, 3)
    return corners[rng.integers(len(corners), size=count)]


def _triangles(parts: Sequence[MeshPart]) -> Triangles:
    return np.concatenate([part.vertices[part.faces] for part in parts])


def _fewer(part: MeshPart, share: float) -> MeshPart:
    """The part with a share of its triangles; pictures stay where they are, which keeps the seams of their mapping."""
    count = max(12, round(share * len(part.faces)))
    if count >= len(part.faces):
        return part
    if part.picture is None:
        first, place = welded(part.vertices)
        points, faces = fast_simplification.simplify(
            part.vertices[first], place[part.faces].astype(np.int32), target_count=count
        )[:2]
        return replace(part, vertices=np.asarray(points, np.float64), faces=np.asarray(faces, np.int64))
    return _fewer_with_picture(part, part.picture, count)


def _fewer_with_picture(part: MeshPart, picture: Picture, count: int) -> MeshPart:
    """Vertices are one where place and texture coordinates are; a new vertex has the mean of what went into it."""
    corners = np.concatenate([part.vertices[part.faces].reshape(-1, 3), picture.corner_uv.reshape(-1, 2)], axis=1)
    place, on_picture = welded(corners[:, :3])[1], welded(np.pad(corners[:, 3:], ((0, 0), (0, 1))))[1]
    key = (place.astype(np.int64) << 32) | on_picture
    _, first, vertex = np.unique(key, return_index=True, return_inverse=True)
    points, uv, faces = corners[first, :3], corners[first, 3:], vertex.reshape(-1, 3).astype(np.int32)
    *_, collapses = fast_simplification.simplify(
        points, faces, target_count=count, return_collapses=True, preserve_border=True
    )
    new, kept, into = fast_simplification.replay_simplification(points, faces, collapses)
    weight = np.bincount(into, minlength=len(new))
    mean = np.stack([np.bincount(into, uv[:, k], len(new)) for k in range(2)], axis=1) / np.maximum(weight, 1)[:, None]
    kept = np.asarray(kept, np.int64)
    moved = replace(picture, corner_uv=mean[kept])
    return replace(part, vertices=np.asarray(new, np.float64), faces=kept, picture=moved)
