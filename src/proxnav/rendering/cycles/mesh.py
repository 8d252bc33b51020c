"""The target's mesh as Blender wants it: one normal per vertex, float32."""

import numpy as np

from proxnav.rendering.cycles.wire import Arrays
from proxnav.targets import Target


def mesh_arrays(target: Target) -> Arrays:
    """Vertices split where corner normals differ, so that Blender's per-vertex normals are the target's exactly."""
    corners = np.hstack([target.vertices_m[target.faces.ravel()], target.corner_normals.reshape(-1, 3)])
    keys = np.hstack([target.faces.reshape(-1, 1), np.round(target.corner_normals.reshape(-1, 3) * 1e6)])
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return {
        "vertices": corners[first, :3].astype(np.float32),
        "normals": corners[first, 3:].astype(np.float32),
        "faces": inverse.reshape(-1, 3).astype(np.int32),
        "face_part": target.face_part.astype(np.int32),
        "corner_uv": target.corner_uv_m.reshape(-1, 2).astype(np.float32),
    }
