"""Meshes that are finer than any camera sees, by fewer triangles, with a measured bound on what that moves.

Quadric error metrics: M. Garland, P. Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997.
"""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import replace

import fast_simplification
import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import KDTree

from proxnav.targets.cad.image_tile import Picture
from proxnav.targets.cad.mesh_part import MeshPart
from proxnav.targets.cad.welding import welded
from proxnav.targets.keypoints.visibility import embree_caster
from proxnav.targets.surface.mapping import face_normals

MOST_TRIANGLES = 300_000
MOST_PX = 0.5
"""What the outline may move at the nearest range [px] without a word of warning."""
AGGRESSIVENESS = 3.0
"""How fast the tolerance of fast_simplification grows: its own choice of 7 tears meshes of millions of triangles."""
N_PROBES = 50_000
N_WORST = 2000
N_SAMPLES = 300_000
Triangles = Float[np.ndarray, "_n corner=3 3"]


def decimated(parts: Sequence[MeshPart], pixel_m: float, say: Callable[[str], None]) -> list[MeshPart]:
    """The parts with at most MOST_TRIANGLES together, and a sentence about the largest distance between the surfaces.

    `pixel_m` is what a pixel covers at the nearest range. No outline moves by more than the surfaces do.
    """
    total = sum(len(part.faces) for part in parts)
    if total <= MOST_TRIANGLES:
        return list(parts)
    say(f"decimating {total} triangles to {MOST_TRIANGLES}")
    kept = [_fewer(part, MOST_TRIANGLES / total) for part in parts]
    say("measuring what that moves")
    gap = surface_gap(_triangles(parts), _triangles(kept))
    count = sum(len(part.faces) for part in kept)
    warning = "" if gap <= MOST_PX * pixel_m else "; decimate it in CAD where that matters"
    say(
        f"decimated {total} triangles to {count}: no surface moves by more than {1e3 * gap:.3g} mm "
        f"({gap / pixel_m:.2g} px at the nearest range){warning}"
    )
    return kept


def surface_gap(a: Triangles, b: Triangles) -> float:
    """Largest distance [m] of points on either surface from the other, over N_PROBES random points of each."""
    rng = np.random.default_rng(0)
    return max(_one_way(a, b, rng), _one_way(b, a, rng))


def _one_way(probed: Triangles, other: Triangles, rng: np.random.Generator) -> float:
    """Largest distance of points of one surface from another, never less than the true one.

    Every point of the other surface is at least as far as the nearest: rays both ways along the normal, and along the
    axes and diagonals for the worst, find near ones, samples of the surface find one where no ray meets it.
    """
    samples, _ = _samples(other, N_SAMPLES, rng)
    probes, of = _samples(probed, N_PROBES, rng)
    probes[::2] = probed[of[::2], 0]  # corners, where surfaces depart most
    nearest = KDTree(samples).query(probes)[0]
    axes = np.array([d for d in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(d)])
    normal = face_normals(probed[of].reshape(-1, 3), np.arange(3 * len(of)).reshape(-1, 3))
    try:
        cast = embree_caster(other.reshape(-1, 3), np.arange(3 * len(other)).reshape(-1, 3))
    except ImportError:
        return float(nearest.max())
    for along in (normal, -normal):
        nearest = np.minimum(nearest, cast(probes, along)[0])
    worst = np.argsort(nearest)[-N_WORST:]  # the largest alone counts
    for along in axes / np.linalg.norm(axes, axis=1, keepdims=True):
        nearest[worst] = np.minimum(nearest[worst], cast(probes[worst], np.broadcast_to(along, (len(worst), 3)))[0])
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
            part.vertices[first], place[part.faces].astype(np.int32), target_count=count, agg=AGGRESSIVENESS
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
        points, faces, target_count=count, agg=AGGRESSIVENESS, return_collapses=True, preserve_border=True
    )
    new, kept, into = fast_simplification.replay_simplification(points, faces, collapses)
    weight = np.bincount(into, minlength=len(new))
    mean = np.stack([np.bincount(into, uv[:, k], len(new)) for k in range(2)], axis=1) / np.maximum(weight, 1)[:, None]
    kept = np.asarray(kept, np.int64)
    moved = replace(picture, corner_uv=mean[kept])
    return replace(part, vertices=np.asarray(new, np.float64), faces=kept, picture=moved)
