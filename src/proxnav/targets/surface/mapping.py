"""Shading normals and texture coordinates for any triangle mesh."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float, Int

Vertices = Float[np.ndarray, "n_vertices 3"]
Faces = Int[np.ndarray, "n_faces 3"]
Indices = Int[np.ndarray, "n_pairs"]


def face_normals(vertices_m: Vertices, faces: Faces) -> Float[np.ndarray, "n_faces 3"]:
    """Unit normals, outward for counter-clockwise triangles; +z for a triangle without area."""
    a, b, c = (vertices_m[faces[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return np.where(length > 0, normal / np.where(length > 0, length, 1.0), [0.0, 0.0, 1.0])


def corner_uv_m(vertices_m: Vertices, faces: Faces) -> Float[np.ndarray, "n_faces 3 2"]:
    """Box mapping [m]: each face is seen along the axis that its normal is nearest to.

    The axes of u and v are cyclic, so that (tangent, bitangent, normal) is right-handed on all six sides.
    """
    normal = face_normals(vertices_m, faces)
    axis = np.argmax(np.abs(normal), axis=1)
    rows = np.arange(len(faces))
    sign = np.where(normal[rows, axis] < 0, -1.0, 1.0)
    corners = vertices_m[faces]
    u = corners[rows, :, (axis + 1) % 3] * sign[:, None]
    return np.stack([u, corners[rows, :, (axis + 2) % 3]], axis=-1)


def corner_normals(
    vertices_m: Vertices, faces: Faces, smooth_angle: float = 0.6, weld_m: float = 1e-6
) -> Float[np.ndarray, "n_faces 3 3"]:
    """Normals at the corners: mean of the faces about a vertex whose normals differ by less than `smooth_angle` [rad].

    Faces are weighted by their angle at the vertex (G. Thuermer, C. Wuethrich, J. Graphics Tools 3(1), 1998), so that
    the result does not depend on how a surface is cut into triangles. Vertices closer than `weld_m` count as one.
    """
    normal = face_normals(vertices_m, faces)
    vertex = _welded(vertices_m, weld_m)[faces].reshape(-1)
    weight = corner_angles(vertices_m, faces).reshape(-1)
    total = normal[np.arange(len(vertex)) // 3].copy()
    total *= weight[:, None]
    for first, second in _pairs_about_vertices(vertex):
        near = np.einsum("ij,ij->i", normal[first // 3], normal[second // 3]) > np.cos(smooth_angle)
        first, second = first[near], second[near]
        for k in range(3):
            total[:, k] += np.bincount(first, weight[second] * normal[second // 3, k], len(vertex))
    length = np.linalg.norm(total, axis=1, keepdims=True)
    flat = np.repeat(normal, 3, axis=0)
    smooth = np.where(length > 1e-12, total / np.where(length > 1e-12, length, 1.0), flat)
    return smooth.reshape(-1, 3, 3)


def _welded(vertices_m: Vertices, weld_m: float) -> Int[np.ndarray, "n_vertices"]:
    """For each vertex the index of the first one at its place."""
    if len(vertices_m) == 0:
        return np.zeros(0, dtype=np.int64)
    keys = np.round(vertices_m / weld_m).astype(np.int64)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return first[inverse.reshape(-1)]


def corner_angles(vertices_m: Vertices, faces: Faces) -> Float[np.ndarray, "n_faces 3"]:
    """Angle [rad] of each triangle at each of its corners; 0 where an edge has no length."""
    p = vertices_m[faces]
    to_next, to_last = np.roll(p, -1, axis=1) - p, np.roll(p, 1, axis=1) - p
    lengths = np.linalg.norm(to_next, axis=2) * np.linalg.norm(to_last, axis=2)
    cosine = np.einsum("ijk,ijk->ij", to_next, to_last) / np.maximum(lengths, 1e-300)
    return np.where(lengths > 0, np.arccos(np.clip(cosine, -1.0, 1.0)), 0.0)


def _pairs_about_vertices(vertex: Int[np.ndarray, "n_corners"]) -> Iterator[tuple[Indices, Indices]]:
    """Ordered pairs (i, j), i != j, of corners at the same vertex; one batch for each distance in the ring."""
    order = np.argsort(vertex, kind="stable")
    _, start, count = np.unique(vertex[order], return_index=True, return_counts=True)
    begin, size = np.repeat(start, count), np.repeat(count, count)
    position = np.arange(len(vertex)) - begin
    here = np.arange(len(vertex))
    for step in range(1, int(count.max(initial=1))):
        here = here[size[here] > step]
        yield order[here], order[begin[here] + (position[here] + step) % size[here]]
