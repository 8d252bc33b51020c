"""Prints the SHA-256 of a few frames as JSON: run by a test in processes of its own."""

import hashlib
import json
import sys

import numpy as np
import trimesh
from raycast_shapes import MATT, scene, target

from proxnav.geometry import Camera, Pose, quaternion
from proxnav.rendering.raycast import RaycastRenderer
from proxnav.targets import Material


def main(indices: list[int]) -> None:
    """Frames of three attitudes of a small craft."""
    meshes = [trimesh.creation.icosphere(subdivisions=2), trimesh.creation.box((4.0, 0.1, 1.0))]
    renderer = RaycastRenderer(target(meshes, [MATT, Material(roughness=0.2, metallic=0.5)]))
    camera = Camera(96, 96, 120.0, 120.0, 48.0, 48.0, (-0.2, 0.1, 0.0, 0.0, 0.0))
    result = {}
    for index in indices:
        q = quaternion.exp(np.array([0.3, 0.7 * index, -0.2]))
        pose = Pose.from_wxyz("cam", "target", q, [0.1, -0.1, 7.0])
        frame = renderer.render(scene(camera, sun=(0.6, -0.3, -0.7), pose=pose))
        arrays = (frame.radiance, frame.depth_m, frame.part, frame.coverage)
        result[str(index)] = hashlib.sha256(b"".join(array.tobytes() for array in arrays)).hexdigest()
    print(json.dumps(result))


if __name__ == "__main__":
    main([int(argument) for argument in sys.argv[1:]])
