"""From pieces to a Target: one mesh with parts, shading normals and texture coordinates."""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float, Int

from proxnav.targets.solids import Piece
from proxnav.targets.surface.mapping import corner_normals, corner_uv_m
from proxnav.targets.surface.material import Material
from proxnav.targets.target import Target


def assemble(
    name: str,
    pieces: Sequence[Piece],
    finish: Mapping[str, Material],
    keypoints: Mapping[str, tuple[float, float, float]],
    subsets: Mapping[str, tuple[int, ...]],
    licence: str,
    source: str,
) -> Target:
    """Pieces of the same part are joined; normals are smoothed wherever faces share vertices, also across parts."""
    part_names = tuple(dict.fromkeys(piece.part for piece in pieces))
    vertices, faces, part = _join(pieces, part_names)
    return Target(
        name=name,
        vertices_m=vertices,
        faces=faces,
        face_part=part,
        part_names=part_names,
        materials=tuple(finish[part_name] for part_name in part_names),
        corner_normals=corner_normals(vertices, faces),
        corner_uv_m=corner_uv_m(vertices, faces),
        keypoints_m=np.array(list(keypoints.values()), dtype=np.float64).reshape(-1, 3),
        keypoint_names=tuple(keypoints),
        subsets=dict(subsets),
        licence=licence,
        source=source,
    )


def _join(
    pieces: Sequence[Piece], part_names: tuple[str, ...]
) -> tuple[Float[np.ndarray, "n 3"], Int[np.ndarray, "m 3"], Int[np.ndarray, "m"]]:
    """Vertices, faces and part indices of all pieces; vertices that no face uses are dropped."""
    vertices, faces, part, offset = [], [], [], 0
    for piece in pieces:
        used, index = np.unique(piece.faces, return_inverse=True)
        vertices.append(piece.vertices_m[used])
        faces.append(index.reshape(-1, 3) + offset)
        part.append(np.full(len(piece.faces), part_names.index(piece.part)))
        offset += len(used)
    return np.concatenate(vertices), np.concatenate(faces), np.concatenate(part)
