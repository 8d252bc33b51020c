"""The spacecraft before the camera: mesh, parts, materials and named keypoints, in its own body frame."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float, Int

from proxnav.errors import InputError
from proxnav.geometry.arrays import frozen
from proxnav.geometry.types import Points
from proxnav.targets.surface.material import Material


@dataclass(frozen=True, slots=True, eq=False)
class Target:
    """A rigid spacecraft, in metres and the target frame; triangles are counter-clockwise seen from outside."""

    name: str
    vertices_m: Float[np.ndarray, "n_vertices 3"]
    faces: Int[np.ndarray, "n_faces 3"]
    """Vertex indices, kept as int32."""
    face_part: Int[np.ndarray, "n_faces"]
    """Index into `part_names`, kept as int32."""
    part_names: tuple[str, ...]
    materials: tuple[Material, ...]
    """One per part."""
    corner_normals: Float[np.ndarray, "n_faces corner=3 3"]
    """Shading normals at the corners of each face, unit."""
    corner_uv_m: Float[np.ndarray, "n_faces corner=3 2"]
    """Texture coordinates [m] on the surface at the corners of each face."""
    keypoints_m: Points
    keypoint_names: tuple[str, ...]
    subsets: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    """Named selections of keypoints, such as `six`: indices into the keypoint list."""
    licence: str = "unknown"
    source: str = "unknown"

    def __post_init__(self) -> None:
        m, k = len(self.faces), len(self.keypoint_names)
        object.__setattr__(self, "vertices_m", frozen(self.vertices_m, (None, 3), "vertices_m"))
        object.__setattr__(self, "faces", frozen(self.faces, (m, 3), "faces", np.int32))
        object.__setattr__(self, "face_part", frozen(self.face_part, (m,), "face_part", np.int32))
        object.__setattr__(self, "corner_normals", frozen(self.corner_normals, (m, 3, 3), "corner_normals"))
        object.__setattr__(self, "corner_uv_m", frozen(self.corner_uv_m, (m, 3, 2), "corner_uv_m"))
        object.__setattr__(self, "keypoints_m", frozen(self.keypoints_m, (k, 3), "keypoints_m"))
        if len(self.part_names) != len(self.materials):
            raise InputError(f"target {self.name}: {len(self.part_names)} parts but {len(self.materials)} materials")

    @property
    def radius_m(self) -> float:
        """Radius of the sphere about the frame's origin that holds the mesh."""
        return float(np.linalg.norm(self.vertices_m, axis=1).max())

    def with_subset(self, name: str) -> "Target":
        """The same spacecraft with only the keypoints of a named subset."""
        if name not in self.subsets:
            raise InputError(f"target {self.name} has no keypoint subset '{name}', only {', '.join(self.subsets)}")
        index = list(self.subsets[name])
        names = tuple(self.keypoint_names[i] for i in index)
        return replace(self, keypoints_m=self.keypoints_m[index], keypoint_names=names, subsets={})
