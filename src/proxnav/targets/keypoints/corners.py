"""How much of a corner a vertex is: what the normals about it say, and the rims of sheets that have no thickness."""

import numpy as np
from jaxtyping import Float, Int

from proxnav.targets.surface.mapping import Faces, Vertices, corner_angles, face_normals

_RIM_WEIGHT = 0.5 * np.pi
_OPPOSITE = -0.999
"""Cosine between the normals of two faces that lie back to back."""


def sharpness(vertices_m: Vertices, faces: Faces) -> Float[np.ndarray, "n_vertices"]:
    """1 - |mean of the unit normals about each vertex|, each weighted by its triangle's angle there.

    Weighting by area would call the corner of a thin plate flat: its rim has an angle there, but no area.
    """
    vertex, normal, weight = _about(vertices_m, faces)
    total = np.stack([np.bincount(vertex, weight * normal[:, k], len(vertices_m)) for k in range(3)], axis=1)
    sums = np.bincount(vertex, weight, len(vertices_m))
    return np.where(sums > 0, 1.0 - np.linalg.norm(total, axis=1) / np.maximum(sums, 1e-300), 0.0)


def corner_turn(vertices_m: Vertices, faces: Faces) -> Float[np.ndarray, "n_vertices"]:
    """Least eigenvalue of the mean of n n^T over the unit normals n about each vertex, weighted by their angles there.

    0 on a flat and along a straight edge or rim, whose normals span a plane at most; 1/3 at a cube's corner.
    """
    vertex, normal, weight = _about(vertices_m, faces)
    spread = np.zeros((len(vertices_m), 3, 3))
    for i, j in np.ndindex(3, 3):
        spread[:, i, j] = np.bincount(vertex, weight * normal[:, i] * normal[:, j], len(vertices_m))
    sums = np.bincount(vertex, weight, len(vertices_m))
    return np.linalg.eigvalsh(spread / np.maximum(sums, 1e-300)[:, None, None])[:, 0]


def _about(
    vertices_m: Vertices, faces: Faces
) -> tuple[Int[np.ndarray, "k"], Float[np.ndarray, "k 3"], Float[np.ndarray, "k"]]:
    """(vertex, unit normal, weight) of every triangle's corner, and of rims of sheets as if those had a thickness."""
    normal, angle = face_normals(vertices_m, faces), corner_angles(vertices_m, faces)
    ends, outward = _rims(vertices_m, faces, normal)
    vertex = np.concatenate([faces.ravel(), ends.ravel()])
    normals = np.concatenate([np.repeat(normal, 3, axis=0), np.repeat(outward, 2, axis=0)])
    return vertex, normals, np.concatenate([angle.ravel(), np.full(ends.size, _RIM_WEIGHT)])


def _rims(
    vertices_m: Vertices, faces: Faces, normal: Float[np.ndarray, "n_faces 3"]
) -> tuple[Int[np.ndarray, "r 2"], Float[np.ndarray, "r 3"]]:
    """(ends, outward normal in the sheet's plane) of edges of one triangle, or of two that lie back to back."""
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    face = np.repeat(np.arange(len(faces)), 3)
    along = vertices_m[ends[:, 1]] - vertices_m[ends[:, 0]]
    whole = np.linalg.norm(along, axis=1) > 0
    ends, face, along = ends[whole], face[whole], along[whole]
    low, high = ends.min(axis=1).astype(np.int64), ends.max(axis=1)
    _, edge, count = np.unique((low << 32) | high, return_inverse=True, return_counts=True)
    edge = edge.reshape(-1)
    total = np.stack([np.bincount(edge, normal[face, k]) for k in range(3)], axis=1)
    back_to_back = (count == 2) & (0.5 * np.einsum("ij,ij->i", total, total) - 1.0 < _OPPOSITE)
    rim = ((count == 1) | back_to_back)[edge]
    outward = np.cross(along[rim], normal[face[rim]])
    return ends[rim], outward / np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-300)
