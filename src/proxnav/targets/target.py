"""The spacecraft before the camera: mesh, parts, materials and named keypoints, in its own body frame."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int

from proxnav.errors import InputError
from proxnav.geometry import Pose
from proxnav.geometry.arrays import frozen
from proxnav.geometry.types import Points, Vector3
from proxnav.targets.surface.material import Material
from proxnav.targets.surface.part_image import PartImage

CENTRE_OF_MASS = "centre_of_mass"


@dataclass(frozen=True, slots=True, eq=False)
class Target:
    """A rigid spacecraft, in metres and the target frame; triangles are counter-clockwise seen from outside.

    The target frame is that of the CAD file in metres, unless whoever made the target chose another origin or axes.
    """

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
    frames: Mapping[str, Pose] = field(default_factory=dict)
    """T_target_NAME of each named frame: `docking_port`, `centre_of_mass`, and `file`, the CAD file's own."""
    images: Mapping[str, PartImage] = field(default_factory=dict)
    """Pictures that cover parts, by the part's name; `corner_uv_m` then lies on them."""

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
        wrong = [name for name, pose in self.frames.items() if pose.frames != ("target", name)]
        if wrong:
            raise InputError(f"target {self.name}: frame '{wrong[0]}' needs a pose T_target_{wrong[0]}")

    @property
    def radius_m(self) -> float:
        """Radius of the sphere about the frame's origin that holds the mesh."""
        return float(np.linalg.norm(self.vertices_m, axis=1).max())

    @property
    def size_m(self) -> float:
        """Radius that tolerances are shares of: of the sphere that holds the mesh, about the frame's origin where that
        lies in the bounding box, about the box's middle where a CAD file has it elsewhere.
        """
        return _size_m(self)

    @property
    def centre_of_mass_m(self) -> Vector3:
        """Centre of mass in the target frame [m]; InputError where nobody said where it lies."""
        if CENTRE_OF_MASS not in self.frames:
            raise InputError(
                f"target {self.name} has no centre of mass; make it with target new --centre-of-mass X,Y,Z"
            )
        return self.frames[CENTRE_OF_MASS].t_m

    def with_subset(self, name: str) -> "Target":
        """The same spacecraft with only the keypoints of a named subset."""
        if name not in self.subsets:
            raise InputError(f"target {self.name} has no keypoint subset '{name}', only {', '.join(self.subsets)}")
        index = list(self.subsets[name])
        names = tuple(self.keypoint_names[i] for i in index)
        return replace(self, keypoints_m=self.keypoints_m[index], keypoint_names=names, subsets={})


@lru_cache(maxsize=8)
def _size_m(target: Target) -> float:
    """Kept, because every look at keypoints asks for it and meshes may have a million vertices."""
    low, high = target.vertices_m.min(axis=0), target.vertices_m.max(axis=0)
    middle = np.where(((low <= 0) & (high >= 0)).all(), np.zeros(3), 0.5 * (low + high))
    return float(np.linalg.norm(target.vertices_m - middle, axis=1).max())
