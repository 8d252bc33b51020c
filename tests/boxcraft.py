"""A small craft for tests that need some target and not a certain one: a box with a fin, eight keypoints."""

import numpy as np

from proxnav.targets import Material, Target

CORNERS = np.array([[x, y, z] for x in (-1.5, 1.5) for y in (-1.0, 1.0) for z in (-0.6, 0.6)])
QUADS = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def boxcraft() -> Target:
    """Box of 3 x 2 x 1.2 m, keypoints on its corners, every side its own part."""
    faces = np.array([triangle for a, b, c, d in QUADS for triangle in ((a, b, c), (a, c, d))], dtype=np.int32)
    corners = CORNERS[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    if (np.einsum("fi,fi->f", normals, corners.mean(axis=1)) < 0).any():
        raise AssertionError("a side of the test box faces inwards")
    tones = np.linspace(0.1, 0.9, len(QUADS))
    return Target(
        name="boxcraft",
        vertices_m=CORNERS,
        faces=faces,
        face_part=np.repeat(np.arange(len(QUADS)), 2),
        part_names=tuple(f"side{i}" for i in range(len(QUADS))),
        materials=tuple(Material(albedo=(tone, tone, tone)) for tone in tones),
        corner_normals=np.repeat(normals[:, None], 3, axis=1),
        corner_uv_m=corners[..., :2],
        keypoints_m=CORNERS,
        keypoint_names=tuple(f"corner{i}" for i in range(8)),
        subsets={"six": (0, 1, 2, 4, 6, 7)},
        licence="Apache-2.0",
    )
