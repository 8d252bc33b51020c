"""Closed solids to build spacecraft from; triangles are counter-clockwise seen from outside."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from proxnav.geometry.arrays import unit


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """Some triangles of one part, in the target frame."""

    part: str
    vertices_m: Float[np.ndarray, "n_vertices 3"]
    faces: Int[np.ndarray, "n_faces 3"]


def box(part: str, low: tuple[float, float, float], high: tuple[float, float, float]) -> Piece:
    """Axis-parallel box between two opposite corners."""
    corner = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)], dtype=np.float64)
    vertices = np.asarray(low) + corner * (np.asarray(high) - np.asarray(low))
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return Piece(part, vertices, np.array(faces))


def revolve(part: str, profile: list[tuple[float, float]], n_around: int = 32) -> Piece:
    """Surface of revolution about +x of a polyline of (x, radius); end points of radius 0 close it.

    The profile runs with falling x over the outside: then normals point away from the axis.
    """
    x, r = np.array(profile, dtype=np.float64).T
    a = np.arange(n_around) * 2 * np.pi / n_around
    rings = np.stack(
        [np.broadcast_to(x[:, None], (len(x), n_around)), r[:, None] * np.cos(a), r[:, None] * np.sin(a)], -1
    )
    faces = loft_faces(len(x), n_around)[:, ::-1]
    return Piece(part, *_without_slivers(rings.reshape(-1, 3), faces))


def aim(piece: Piece, origin: tuple[float, float, float], axis: tuple[float, float, float]) -> Piece:
    """The piece turned so that its +x points along `axis`, then moved so that its origin lies at `origin`."""
    x = unit(np.asarray(axis, dtype=np.float64))
    helper = np.eye(3)[np.argmin(np.abs(x))]
    y = unit(np.cross(helper, x))
    R = np.stack([x, y, np.cross(x, y)], axis=1)
    return Piece(piece.part, piece.vertices_m @ R.T + np.asarray(origin), piece.faces)


def moved(piece: Piece, by_m: tuple[float, float, float]) -> Piece:
    """The piece shifted."""
    return Piece(piece.part, piece.vertices_m + np.asarray(by_m), piece.faces)


def rod(part: str, start: tuple[float, float, float], end: tuple[float, float, float], radius: float) -> Piece:
    """Round rod between two points."""
    along = np.asarray(end, dtype=np.float64) - np.asarray(start)
    length = float(np.linalg.norm(along))
    bar = revolve(part, [(length, 0.0), (length, radius), (0.0, radius), (0.0, 0.0)], 10)
    return aim(bar, start, (float(along[0]), float(along[1]), float(along[2])))


def ball(part: str, centre: tuple[float, float, float], radius: float, n: int = 12) -> Piece:
    """Sphere."""
    a = np.linspace(0, np.pi, n)
    profile = [(radius * float(np.cos(t)), radius * float(np.sin(t))) for t in a]
    return aim(revolve(part, profile, 2 * n), centre, (1.0, 0.0, 0.0))


def loft_faces(n_stations: int, n_ring: int) -> Int[np.ndarray, "n_faces 3"]:
    """Triangles between consecutive closed rings of a loft, two for each quad, station by station."""
    i, j = np.meshgrid(np.arange(n_stations - 1), np.arange(n_ring), indexing="ij")
    k = (j + 1) % n_ring
    a, b, c, d = i * n_ring + j, i * n_ring + k, (i + 1) * n_ring + k, (i + 1) * n_ring + j
    return np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], axis=2).reshape(-1, 3)


def _without_slivers(
    vertices: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]
) -> tuple[Float[np.ndarray, "k 3"], Int[np.ndarray, "j 3"]]:
    """Coincident vertices merged and triangles without area dropped: poles become single points."""
    merged, index = np.unique(np.round(vertices, 9), axis=0, return_inverse=True)
    f = index.reshape(-1)[faces]
    keep = (f[:, 0] != f[:, 1]) & (f[:, 1] != f[:, 2]) & (f[:, 2] != f[:, 0])
    return merged, f[keep]
