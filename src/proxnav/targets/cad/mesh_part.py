"""One part of a mesh on its way from a file to a target."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from proxnav.targets.cad.image_tile import Picture
from proxnav.targets.surface.material import Material


@dataclass(frozen=True, slots=True, eq=False)
class MeshPart:
    """Triangles of one material, in the axes and unit of their file or, once placed, in the target frame [m]."""

    name: str
    vertices: Float[np.ndarray, "n 3"]
    faces: Int[np.ndarray, "m 3"]
    material: Material
    picture: Picture | None = None
    """What the file lays over it; the material's albedo is a factor on its colours then."""
