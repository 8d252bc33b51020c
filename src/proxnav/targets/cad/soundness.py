"""Whether meshes are whole: winding that faces outward, edges that close, edges that no solid can have."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from proxnav.targets.cad.welding import welded
from proxnav.targets.keypoints.visibility import embree_caster
from proxnav.targets.surface.mapping import face_normals
from proxnav.targets.target import Target

N_RAYS = 40_000
"""Rays from all around that vote on which side of a surface is outside."""
DECIDED = 0.8
"""Share of votes from which on a surface has an outside."""
FEWEST_VOTES = 8
Faces = Int[np.ndarray, "m 3"]
Vertices = Float[np.ndarray, "n 3"]


@dataclass(frozen=True, slots=True, eq=False)
class _Edges:
    """Edges of triangles, one row for each side of a triangle, in the order of the edges' places."""

    edge: Int[np.ndarray, "k"]
    """Index of the undirected edge."""
    face: Int[np.ndarray, "k"]
    forward: Bool[np.ndarray, "k"]
    """Whether the triangle runs along it from the lower to the higher vertex."""
    count: Int[np.ndarray, "n_edges"]
    """Triangles at each edge."""


def outward(vertices: Vertices, faces: Faces) -> tuple[Faces, Bool[np.ndarray, "m"]]:
    """(triangles turned to face outward where that can be decided, which of them were turned).

    Neighbours are made to agree first; then each connected piece is turned as most rays from outside see it, or, where
    too few reach it, so that the volume that it closes is positive.
    """
    edges = _edges(welded(vertices)[1][faces])
    piece, odd = _agreed(edges, len(faces))
    flip = odd ^ (np.bincount(piece, odd) > 0.5 * np.bincount(piece))[piece]  # as most of the piece has it
    agreed = np.where(flip[:, None], faces[:, ::-1], faces)
    votes, seen = _votes(vertices, agreed, piece)
    volume = np.bincount(piece, _volumes(vertices, agreed))
    closed = np.bincount(piece, np.bincount(edges.face, edges.count[edges.edge] != 2, len(faces))) == 0
    inside_out = np.where(seen >= FEWEST_VOTES, votes < (1 - 2 * DECIDED) * seen, closed & (volume < 0) & (seen == 0))
    flip = flip ^ inside_out[piece]
    return np.where(flip[:, None], faces[:, ::-1], faces), flip


def soundness(target: Target) -> Iterator[str]:
    """One sentence each for parts that are open and for edges where more than two triangles meet."""
    opened, crowded, crowded_edges = [], [], 0
    for index, name in enumerate(target.part_names):
        faces = target.faces[target.face_part == index]
        used, inverse = np.unique(faces, return_inverse=True)
        count = _edges(welded(target.vertices_m[used])[1][inverse.reshape(-1, 3)]).count
        opened += [name] if (count == 1).any() else []
        crowded += [name] if (count > 2).any() else []
        crowded_edges += int((count > 2).sum())
    total = len(target.part_names)
    if opened:
        yield (
            f"{len(opened)} of {total} parts are open surfaces, not closed solids ({_listed(opened)}): drawn from both "
            "sides, without an inside"
        )
    if crowded:
        yield (
            f"{len(crowded)} of {total} parts are not manifold ({_listed(crowded)}): more than two triangles meet at "
            f"{crowded_edges} edges; harmless for drawing, but CAD would call them broken"
        )


def _listed(names: list[str]) -> str:
    return ", ".join(names[:4]) + (", ..." if len(names) > 4 else "")


def _edges(faces: Faces) -> _Edges:
    """The sides of all triangles that have three different corners."""
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    which = np.flatnonzero(whole)
    start, end = faces[which].ravel(), np.roll(faces[which], -1, axis=1).ravel()
    low, high = np.minimum(start, end), np.maximum(start, end)
    _, edge, count = np.unique((low.astype(np.int64) << 32) | high, return_inverse=True, return_counts=True)
    return _Edges(edge.reshape(-1), np.repeat(which, 3), start < end, count)


def _agreed(edges: _Edges, n_faces: int) -> tuple[Int[np.ndarray, "m"], Bool[np.ndarray, "m"]]:
    """(connected piece of each face, whether it must be turned to agree with the first of its piece).

    Two copies of every face, as it is and turned; a copy is linked with the copy of its neighbour that agrees.
    """
    order = np.argsort(edges.edge, kind="stable")
    order = order[edges.count[edges.edge[order]] == 2]
    first, second = order[0::2], order[1::2]
    f, g = edges.face[first], edges.face[second]
    other = np.where(edges.forward[first] == edges.forward[second], n_faces, 0)
    rows = np.concatenate([f, f + n_faces])
    columns = np.concatenate([g + other, g + n_faces - other])
    links = coo_array((np.ones(len(rows), bool), (rows, columns)), shape=(2 * n_faces, 2 * n_faces))
    label = connected_components(links, directed=False)[1]
    plain = connected_components(coo_array((np.ones(len(f), bool), (f, g)), shape=(n_faces, n_faces)), directed=False)[
        1
    ]
    _, start = np.unique(plain, return_index=True)
    return plain, label[:n_faces] != label[start[plain]]


def _votes(
    vertices: Vertices, faces: Faces, piece: Int[np.ndarray, "m"]
) -> tuple[Float[np.ndarray, "pieces"], Float[np.ndarray, "pieces"]]:
    """(hits from the front less hits from behind, hits) of each piece by rays from outside."""
    n_pieces = int(piece.max(initial=-1)) + 1
    try:
        cast = embree_caster(vertices, faces)
    except ImportError:
        return np.zeros(n_pieces), np.zeros(n_pieces)
    rng = np.random.default_rng(0)
    used = vertices[faces]
    centre = 0.5 * (used.min(axis=(0, 1)) + used.max(axis=(0, 1)))
    aim = used[rng.integers(len(faces), size=N_RAYS)].mean(axis=1)  # small pieces are asked as well
    away = rng.normal(size=(N_RAYS, 3))
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    reach = 2.0 * float(np.linalg.norm(used - centre, axis=2).max())
    face = cast(aim + reach * away, -away)[1]
    hit = face >= 0
    side = np.sign(np.einsum("ij,ij->i", face_normals(vertices, faces)[face[hit]], away[hit]))
    return np.bincount(piece[face[hit]], side, n_pieces), np.bincount(piece[face[hit]], minlength=n_pieces).astype(
        float
    )


def _volumes(vertices: Vertices, faces: Faces) -> Float[np.ndarray, "m"]:
    """Signed volume [m^3] between each triangle and the mesh's middle."""
    a, b, c = (vertices[faces[:, i]] - vertices.mean(axis=0) for i in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
