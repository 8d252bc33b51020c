"""Embree behind two questions: which triangle does a ray meet first, and how far is it."""

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from jaxtyping import Bool, Float, Float32, Int, Int32

Rays = Float32[np.ndarray, "n 3"]

_FAR = np.float32(1e37)


class Tracer:
    """A committed Embree scene; rays are float32 and answered one by one, so the answers depend on nothing else."""

    def __init__(self, vertices: Float[np.ndarray, "n_vertices 3"], faces: Int[np.ndarray, "n_faces 3"]) -> None:
        self._scene = EmbreeScene(robust=True)
        self._mesh = TriangleMesh(self._scene, vertices.astype(np.float32), faces.astype(np.int32))

    def first_hit(self, origins: Rays, directions: Rays) -> Int32[np.ndarray, "n"]:
        """Index of the first triangle along each ray; -1 where there is none."""
        return self._scene.run(origins, directions, query="INTERSECT") if len(origins) else np.zeros(0, np.int32)

    def distance(self, origins: Rays, directions: Rays) -> Float32[np.ndarray, "n"]:
        """Distance to the first triangle in lengths of the direction; inf where there is none."""
        if not len(origins):
            return np.zeros(0, np.float32)
        distance = self._scene.run(origins, directions, query="DISTANCE")
        return np.where(distance >= _FAR, np.float32(np.inf), distance)

    def occluded(self, origins: Rays, directions: Rays) -> Bool[np.ndarray, "n"]:
        """Whether anything lies along each ray."""
        if not len(origins):
            return np.zeros(0, bool)
        return self._scene.run(origins, directions, query="OCCLUDED") >= 0
