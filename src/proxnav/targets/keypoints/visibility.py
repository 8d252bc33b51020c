"""Which keypoints a camera can see, by rays against the mesh; and points spread over its surface."""

from functools import lru_cache
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from proxnav.geometry import Pose
from proxnav.targets.target import Target

HIT_TOLERANCE = 0.01
"""Share of the target's radius by which a surface may lie before a keypoint that belongs to it."""


def visible_keypoints(target: Target, T_cam_target: Pose, tolerance_m: float | None = None) -> Bool[np.ndarray, "k"]:
    """Whether the straight line from the camera's centre to each keypoint is free, up to `tolerance_m` before it.

    Field of view is not considered; a keypoint behind the camera's plane is not visible. Rays run from the keypoint to
    the camera: Embree works in float32, and so its precision does not depend on the range.
    """
    eye = T_cam_target.inverse().t_m
    tolerance = HIT_TOLERANCE * target.size_m if tolerance_m is None else tolerance_m
    in_front = (T_cam_target @ target.keypoints_m)[:, 2] > 0
    return in_front & ~occluded(target, target.keypoints_m, np.broadcast_to(eye, target.keypoints_m.shape), tolerance)


def occluded(
    target: Target, points_m: Float[np.ndarray, "n 3"], eyes_m: Float[np.ndarray, "n 3"], tolerance_m: float
) -> Bool[np.ndarray, "n"]:
    """Whether the mesh cuts the line from each point to its eye, farther than `tolerance_m` from the point."""
    along = eyes_m - points_m
    distance = np.linalg.norm(along, axis=1)
    direction = along / np.maximum(distance, 1e-12)[:, None]
    free = distance - tolerance_m
    hit = first_hits(target, points_m + tolerance_m * direction, direction)
    return (free > 0) & (hit < free)


def first_hits(
    target: Target, origins_m: Float[np.ndarray, "n 3"], directions: Float[np.ndarray, "n 3"]
) -> Float[np.ndarray, "n"]:
    """Distance [m] to the first surface along each unit direction; inf where there is none."""
    return _intersector(target)(origins_m, directions)[0]


def first_faces(
    target: Target, origins_m: Float[np.ndarray, "n 3"], directions: Float[np.ndarray, "n 3"]
) -> tuple[Float[np.ndarray, "n"], Int[np.ndarray, "n"]]:
    """Distance [m] and face index of the first surface along each unit direction; inf and -1 where there is none."""
    return _intersector(target)(origins_m, directions)


def surface_samples(target: Target, n: int, rng: np.random.Generator) -> Float[np.ndarray, "n 3"]:
    """Points spread over the mesh, uniformly by area, in the target frame [m]."""
    a, b, c = (target.vertices_m[target.faces[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    face = rng.choice(len(area), size=n, p=area / area.sum())
    u, v = rng.random((2, n, 1))
    beyond = u + v > 1
    u, v = np.where(beyond, 1 - u, u), np.where(beyond, 1 - v, v)
    return a[face] + u * (b - a)[face] + v * (c - a)[face]


Rays = Float[np.ndarray, "n 3"]
Hits = tuple[Float[np.ndarray, "n"], Int[np.ndarray, "n"]]
"""(distance, face) of each ray; infinite and -1 where it meets nothing."""


@lru_cache(maxsize=8)
def _intersector(target: Target) -> Any:
    """(origins, directions) -> (distances, faces) over the mesh, built once for each target object."""
    try:
        return embree_caster(target.vertices_m, target.faces)
    except ImportError:
        return _every_triangle(target)


def embree_caster(vertices_m: Float[np.ndarray, "n 3"], faces: Int[np.ndarray, "m 3"]) -> Any:
    """(origins, directions) -> (distances, faces) over any triangles; ImportError without Embree."""
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    scene = EmbreeScene()
    mesh = TriangleMesh(scene, vertices_m.astype(np.float32), faces.astype(np.int32))

    def cast(origins: Rays, directions: Rays) -> Hits:
        found = scene.run(origins.astype(np.float32), directions.astype(np.float32), output=True)
        face = np.asarray(found["primID"], dtype=np.int64)
        return np.where(face >= 0, found["tfar"].astype(np.float64), np.inf), face

    cast.__dict__["keep_alive"] = mesh
    return cast


def _every_triangle(target: Target) -> Any:
    """Fallback for machines without Embree: each ray against all triangles, some milliseconds a ray.

    T. Moeller, B. Trumbore, "Fast, minimum storage ray-triangle intersection", J. Graphics Tools 2(1), 1997.
    """
    a, b, c = (target.vertices_m[target.faces[:, i]] for i in range(3))
    e1, e2 = b - a, c - a

    def cast_one(origin: Float[np.ndarray, "3"], direction: Float[np.ndarray, "3"]) -> tuple[float, int]:
        p = np.cross(direction, e2)
        det = np.einsum("ij,ij->i", e1, p)
        scale = 1.0 / np.where(np.abs(det) > 1e-15, det, np.inf)
        s = origin - a
        u, q = np.einsum("ij,ij->i", s, p) * scale, np.cross(s, e1)
        v, t = q @ direction * scale, np.einsum("ij,ij->i", q, e2) * scale
        t = np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0) & (np.abs(det) > 1e-15), t, np.inf)
        face = int(np.argmin(t))
        return float(t[face]), face if np.isfinite(t[face]) else -1

    def cast(origins: Rays, directions: Rays) -> Hits:
        hits = [cast_one(o, d) for o, d in zip(origins, directions, strict=True)]
        return np.array([t for t, _ in hits], dtype=np.float64), np.array([face for _, face in hits], dtype=np.int64)

    return cast
