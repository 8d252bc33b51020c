"""The convex hull of a target: where a camera surely is outside of it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull

from proxnav.geometry.types import Vector3
from proxnav.targets.target import Target


@dataclass(frozen=True, slots=True, eq=False)
class Hull:
    """Half-spaces whose intersection is the convex hull."""

    normals: Float[np.ndarray, "n_planes 3"]
    """Outward, unit, target frame."""
    offsets_m: Float[np.ndarray, "n_planes"]
    """A point p is inside where normals @ p + offsets_m <= 0 for every plane."""

    @staticmethod
    def of(target: Target) -> "Hull":
        """The hull of the target's vertices."""
        planes = ConvexHull(target.vertices_m).equations
        return Hull(planes[:, :3], planes[:, 3])

    def distance_m(self, point_m: Vector3) -> float:
        """Largest signed distance of a point to the planes [m]: a lower bound of its distance, negative inside."""
        return float((self.normals @ point_m + self.offsets_m).max())
