"""The target's triangles as the kernels read them: split until small, with unit tangents and shared light-cache points.

Splitting is linear, so normals and texture coordinates interpolate exactly as over the original triangles.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int, Int32

from proxnav.geometry.types import Vector3
from proxnav.targets import Target

POSITION, CORNER_NORMAL, U, V = 0, 3, 6, 7
"""Places in a corner's row: position [m] (3), shading normal (3, not normalised inside a split triangle) and texture
coordinates [m]."""
TANGENT_U, TANGENT_V = 0, 3
"""Places of the two vectors in a row of tangents."""
Corners = Float[np.ndarray, "_n_faces 3 8"]
Parts = Int[np.ndarray, "_n_faces"]
_MAX_FACES = 400_000
_NEXT = (1, 2, 0)


@dataclass(frozen=True, slots=True, eq=False)
class RenderMesh:
    """Triangles with their attributes, in the target frame [m]."""

    vertices: Float[np.ndarray, "n_vertices 3"]
    faces: Int[np.ndarray, "n_faces 3"]
    corners: Corners
    """POSITION to V of each corner, target axes."""
    normals: Float[np.ndarray, "n_faces 3"]
    """Unit geometric normals, outward by the winding."""
    tangents: Float[np.ndarray, "n_faces 6"]
    """Unit directions of growing u and of growing v."""
    part: Int[np.ndarray, "n_faces"]
    cache: Int[np.ndarray, "n_faces 3"]
    """Index of the light-cache point at each corner."""
    cache_position: Float[np.ndarray, "n_cache 3"]
    cache_normal: Float[np.ndarray, "n_cache 3"]
    cache_part: Int[np.ndarray, "n_cache"]
    centre: Float[np.ndarray, "3"]
    radius: float
    """Radius of the sphere about `centre` that holds the mesh [m]."""


def build_mesh(target: Target, spacing_m: float) -> RenderMesh:
    """The target split so that no edge is longer than `spacing_m` (coarser for meshes that would grow too large)."""
    positions = target.vertices_m[target.faces]
    corners = np.concatenate([positions, target.corner_normals, target.corner_uv_m], axis=2)
    corners, part = _without_slivers(corners, target.face_part)
    corners, part = _split(corners, part, max(spacing_m, 0.02 * target.size_m))
    vertices, index = np.unique(_positions(corners).astype(np.float32).reshape(-1, 3), axis=0, return_inverse=True)
    cache, where, normal, of_part = _cache_points(corners, part)
    centre = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0)).astype(np.float64)
    radius = float(np.linalg.norm(vertices - centre, axis=1).max())
    return RenderMesh(
        vertices, index.reshape(-1, 3).astype(np.int32), corners, _normals(corners), _tangents(corners),
        part.astype(np.int32), cache, where, _unit(normal), of_part, centre, radius,
    )  # fmt: skip


def _without_slivers(corners: Corners, part: Parts) -> tuple[Corners, Parts]:
    """Triangles that have an area; others cannot be hit and have no normal."""
    p = _positions(corners)
    area = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1)
    keep = area > 1e-14
    return corners[keep], part[keep]


def _split(corners: Corners, part: Parts, longest: float) -> tuple[Corners, Parts]:
    """Halves long edges until none is left; neighbours halve a shared edge alike, so no crack opens."""
    while True:
        p = _positions(corners)
        long = np.stack([np.linalg.norm(p[:, k] - p[:, _NEXT[k]], axis=1) > longest for k in range(3)], axis=1)
        if not long.any() or len(corners) > _MAX_FACES:
            return corners, part
        pieces = [_split_case(corners, part, long, case) for case in range(8)]
        corners = np.concatenate([piece[0] for piece in pieces])
        part = np.concatenate([piece[1] for piece in pieces])


def _split_case(corners: Corners, part: Parts, long: Bool[np.ndarray, "_n 3"], case: int) -> tuple[Corners, Parts]:
    """The triangles whose long edges are exactly the bits of `case`, cut at the middles of those edges."""
    pattern = [(case >> k) & 1 for k in range(3)]
    chosen = (long == pattern).all(axis=1)
    c, parts = corners[chosen], part[chosen]
    points = [c[:, 0], c[:, 1], c[:, 2], *(0.5 * (c[:, k] + c[:, _NEXT[k]]) for k in range(3))]
    triangles = _cuts(pattern)
    return np.concatenate([np.stack([points[i] for i in t], axis=1) for t in triangles]), np.tile(parts, len(triangles))


def _cuts(pattern: list[int]) -> list[tuple[int, int, int]]:
    """Triangles over the corners 0-2 and the edge middles 3-5 (middle 3+k lies between k and k+1)."""
    count = sum(pattern)
    if count == 0:
        return [(0, 1, 2)]
    if count == 3:
        return [(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)]
    k = pattern.index(1) if count == 1 else (pattern.index(0) + 1) % 3
    a, b, c = k, _NEXT[k], _NEXT[_NEXT[k]]
    if count == 1:
        return [(a, 3 + a, c), (3 + a, b, c)]
    return [(3 + a, b, 3 + b), (a, 3 + a, 3 + b), (a, 3 + b, c)]


def _cache_points(
    corners: Corners, part: Parts
) -> tuple[
    Int32[np.ndarray, "n_faces 3"], Float[np.ndarray, "n_cache 3"], Float[np.ndarray, "n_cache 3"],
    Int32[np.ndarray, "n_cache"],
]:  # fmt: skip
    """Index per corner, and position, normal and part of each point: corners that share all three are one."""
    position = _positions(corners).reshape(-1, 3)
    normal = _unit(corners[..., CORNER_NORMAL : CORNER_NORMAL + 3].reshape(-1, 3))
    of_part = np.repeat(part, 3).astype(np.int32)
    keys = np.round(np.column_stack([1e4 * position, 20.0 * normal, of_part])).astype(np.int64)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return inverse.reshape(-1, 3).astype(np.int32), position[first], normal[first], of_part[first]


def _positions(corners: Float[np.ndarray, "*batch 8"]) -> Float[np.ndarray, "*batch 3"]:
    return corners[..., POSITION : POSITION + 3]


def _normals(corners: Corners) -> Float[np.ndarray, "_n 3"]:
    p = _positions(corners)
    return _unit(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]))


def _tangents(corners: Corners) -> Float[np.ndarray, "_n 6"]:
    """Unit dP/du and dP/dv of each triangle; any orthogonal pair where the mapping is degenerate."""
    p, uv = _positions(corners), corners[..., U : V + 1]
    e1, e2 = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    (u1, v1), (u2, v2) = (uv[:, 1] - uv[:, 0]).T, (uv[:, 2] - uv[:, 0]).T
    det = u1 * v2 - u2 * v1
    valid = np.abs(det) > 1e-12
    scale = np.where(valid, np.sign(det), 1.0)[:, None]
    du = np.where(valid[:, None], (e1 * v2[:, None] - e2 * v1[:, None]) * scale, e1)
    fallback = np.cross(_normals(corners), e1)
    dv = np.where(valid[:, None], (e2 * u1[:, None] - e1 * u2[:, None]) * scale, fallback)
    return np.concatenate([_unit(du), _unit(dv)], axis=1)


def _unit(v: Vector3) -> Vector3:
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-30)
