"""The edges of a mesh, each with the planes of the two faces that meet there: what an outline is made of."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import trimesh
from jaxtyping import Bool, Float

from proxnav.targets import Target

CREASE_RAD = np.radians(20.0)
"""Faces that meet at a larger angle are seen apart, whatever the light."""


@dataclass(frozen=True, slots=True, eq=False)
class Wireframe:
    """Edges a-b [m, target frame] and the unit normals of their faces; a lone face counts twice."""

    a_m: Float[np.ndarray, "n 3"]
    b_m: Float[np.ndarray, "n 3"]
    normal_1: Float[np.ndarray, "n 3"]
    normal_2: Float[np.ndarray, "n 3"]
    sharp: Bool[np.ndarray, "n"]
    """Whether an edge is a crease, a rim, or a border between two parts."""
    face_normals: Float[np.ndarray, "m 3"]
    """Unit normals of the target's faces, in their order."""


@lru_cache(maxsize=8)
def wireframe(target: Target) -> Wireframe:
    """The edges of the target's mesh, vertices at one place taken for one; built once for each target object."""
    mesh = trimesh.Trimesh(target.vertices_m, target.faces, process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    corners, faces = np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces)
    normals = _normals(corners[faces])
    ends = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, edge_of, count = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    by_edge = np.argsort(edge_of.ravel(), kind="stable") // 3
    first = np.cumsum(count) - count
    one, other = by_edge[first], by_edge[first + np.minimum(count, 2) - 1]
    bent = np.einsum("ij,ij->i", normals[one], normals[other]) < np.cos(CREASE_RAD)
    sharp = (count != 2) | bent | (target.face_part[one] != target.face_part[other])
    ends_m = corners[edges]
    return Wireframe(ends_m[:, 0].copy(), ends_m[:, 1].copy(), normals[one], normals[other], sharp, normals)


def _normals(triangles: Float[np.ndarray, "m 3 3"]) -> Float[np.ndarray, "m 3"]:
    """Unit normals of counter-clockwise triangles; zero where a triangle has no area."""
    n = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-12)
