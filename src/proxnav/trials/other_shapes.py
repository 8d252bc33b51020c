"""Craft that are nearly the target: a wing missing, turned or longer. The picture contradicts the mesh."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float

from proxnav.geometry import so3
from proxnav.targets import Target

_OUTBOARD = 0.3
"""Share of the half span beyond which a face belongs to the wings."""


def modified_shapes(target: Target) -> dict[str, Callable[[], Target]]:
    """Name to maker of each modified craft; the wings are what lies outboard along the widest of the three axes."""
    return {
        "wings turned 10 deg": lambda: turned_wings(target, np.radians(10.0)),
        "wings turned 30 deg": lambda: turned_wings(target, np.radians(30.0)),
        "wings turned 90 deg": lambda: turned_wings(target, np.radians(90.0)),
        "a wing missing": lambda: without_wing(target),
        "span 14 % longer": lambda: longer_span(target, 1.14),
    }


def turned_wings(target: Target, angle_rad: float) -> Target:
    """Both wings turned about the span through their middle."""
    axis, _, outboard = _wings(target)
    vertices, normals = target.vertices_m.copy(), target.corner_normals.copy()
    R = so3.exp(angle_rad * np.eye(3)[axis])
    mine = np.zeros(len(vertices), dtype=bool)
    mine[target.faces[outboard]] = True
    middle = vertices[mine].mean(axis=0)
    vertices[mine] = (vertices[mine] - middle) @ R.T + middle
    normals[outboard] = normals[outboard] @ R.T
    return replace(target, vertices_m=vertices, corner_normals=normals)


def without_wing(target: Target) -> Target:
    """The wing on the negative side left out."""
    _, place, outboard = _wings(target)
    keep = ~(outboard & (place < 0.0))
    return replace(
        target, faces=target.faces[keep], face_part=target.face_part[keep],
        corner_normals=target.corner_normals[keep], corner_uv_m=target.corner_uv_m[keep],
    )  # fmt: skip


def longer_span(target: Target, factor: float) -> Target:
    """The wings stretched along the span, so that the whole span grows by the factor."""
    axis, _, _ = _wings(target)
    vertices = target.vertices_m.copy()
    low, high = vertices[:, axis].min(), vertices[:, axis].max()
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    y = (vertices[:, axis] - middle) / half
    stretch = (factor - _OUTBOARD) / (1.0 - _OUTBOARD)
    far = np.abs(y) > _OUTBOARD
    y[far] = np.sign(y[far]) * (_OUTBOARD + (np.abs(y[far]) - _OUTBOARD) * stretch)
    vertices[:, axis] = middle + half * y
    return replace(target, vertices_m=vertices)


def _wings(target: Target) -> tuple[int, Float[np.ndarray, "n_faces"], Bool[np.ndarray, "n_faces"]]:
    """(axis of the span, place of each face along it in half spans, whether it lies outboard)."""
    low, high = target.vertices_m.min(axis=0), target.vertices_m.max(axis=0)
    axis = int(np.argmax(high - low))
    centres = target.vertices_m[target.faces].mean(axis=1)[:, axis]
    place = (centres - 0.5 * (low + high)[axis]) / (0.5 * (high - low)[axis])
    return axis, place, np.abs(place) > _OUTBOARD
