"""Small scenes for Cycles: plates and balls, sunlit or glowing, before a black sky."""

from collections.abc import Callable

import numpy as np
import pytest
import trimesh

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.records import SceneSpec, SunSpec
from proxnav.targets import Material, Target


@pytest.fixture(scope="session")
def blender() -> None:
    """Skips where Blender is not set up."""
    from proxnav.rendering.cycles.blender import find_blender

    try:
        find_blender()
    except InputError as reason:
        pytest.skip(str(reason))


@pytest.fixture
def make_target() -> Callable[..., Target]:
    """A target of flat-shaded meshes, one part each; `smooth` takes the vertex normals instead."""

    def make(meshes: list[trimesh.Trimesh], materials: list[Material], smooth: bool = False) -> Target:
        offsets = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
        flat = [np.repeat(mesh.face_normals[:, None], 3, axis=1) for mesh in meshes]
        rounded = [mesh.vertex_normals[mesh.faces] for mesh in meshes]
        vertices = np.concatenate([mesh.vertices for mesh in meshes])
        faces = np.concatenate([mesh.faces + offset for mesh, offset in zip(meshes, offsets, strict=False)])
        return Target(
            name="test",
            vertices_m=vertices,
            faces=faces,
            face_part=np.repeat(np.arange(len(meshes)), [len(mesh.faces) for mesh in meshes]),
            part_names=tuple(f"part{i}" for i in range(len(meshes))),
            materials=tuple(materials),
            corner_normals=np.concatenate(rounded if smooth else flat),
            corner_uv_m=vertices[faces][..., :2],
            keypoints_m=np.zeros((0, 3)),
            keypoint_names=(),
        )

    return make


@pytest.fixture
def make_scene() -> Callable[..., SceneSpec]:
    """A scene without Earth."""

    def make(camera: Camera, T_cam_target: Pose, sun: SunSpec | None = None, index: int = 0) -> SceneSpec:
        return SceneSpec(
            index=index,
            target="test",
            camera=camera,
            q_cam_target=tuple(T_cam_target.q_wxyz.tolist()),
            t_cam_target_m=tuple(T_cam_target.t_m.tolist()),
            sun=sun or SunSpec((0.0, 0.0, 1.0)),
        )

    return make
