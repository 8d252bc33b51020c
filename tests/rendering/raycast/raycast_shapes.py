"""Small targets with known geometry, and scenes that look at them."""

from collections.abc import Sequence

import numpy as np
import trimesh

from proxnav.geometry import Camera, Pose
from proxnav.records import SceneSpec, SunSpec
from proxnav.targets import Material, Target

MATT = Material(albedo=(0.2, 0.2, 0.2), ior=1.0, roughness=1.0)
"""A pure Lambertian surface."""


def target(meshes: Sequence[trimesh.Trimesh], materials: Sequence[Material], smooth: bool = False) -> Target:
    """One part per mesh; texture coordinates are x and y."""
    vertices = np.concatenate([mesh.vertices for mesh in meshes])
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    faces = np.concatenate([mesh.faces + n for mesh, n in zip(meshes, first, strict=False)])
    flat = np.concatenate([np.repeat(mesh.face_normals[:, None], 3, axis=1) for mesh in meshes])
    corner = np.concatenate([mesh.vertex_normals for mesh in meshes])[faces] if smooth else flat
    part = np.concatenate([np.full(len(mesh.faces), i) for i, mesh in enumerate(meshes)])
    names = tuple(f"part{i}" for i in range(len(meshes)))
    uv = vertices[faces][..., :2]
    return Target("shapes", vertices, faces, part, names, tuple(materials), corner, uv, np.zeros((1, 3)), ("origin",))


def plate(half: float = 1.0, z: float = 0.0) -> trimesh.Trimesh:
    """A square that faces -z, where the camera of `scene` stands."""
    corners = np.array([[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]])
    return trimesh.Trimesh(corners, [[0, 2, 1], [0, 3, 2]], process=False)


def scene(
    camera: Camera, distance: float = 10.0, sun: Sequence[float] = (0.0, 0.0, -1.0), pose: Pose | None = None, **more
) -> SceneSpec:
    """The target at `distance` before the camera with parallel axes; the Sun behind the camera."""
    pose = pose or Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [0, 0, distance])
    direction = tuple((np.array(sun) / np.linalg.norm(sun)).tolist())
    return SceneSpec(
        0, "shapes", camera, tuple(pose.q_wxyz.tolist()), tuple(pose.t_m.tolist()), SunSpec(direction), **more
    )
