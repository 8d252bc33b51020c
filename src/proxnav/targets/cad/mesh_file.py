"""Triangles and materials of a mesh file, node by node, in the file's own axes and unit."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from proxnav.errors import InputError
from proxnav.targets.cad.mesh_guard import MAX_ELEMENTS, check_mesh_file
from proxnav.targets.cad.plain_glb import plain_glb
from proxnav.targets.cad.texture_tones import Tones, face_tones
from proxnav.targets.surface.material import Material


@dataclass(frozen=True, slots=True, eq=False)
class FilePart:
    """One node's triangles of one tone."""

    name: str
    vertices: Float[np.ndarray, "n 3"]
    faces: Int[np.ndarray, "m 3"]
    material: Material


def read_parts(path: Path) -> list[FilePart]:
    """All drawable nodes of a GLB, glTF, OBJ, STL or PLY file, transforms applied; names are unique."""
    kind = check_mesh_file(path)
    unpacked = plain_glb(path) if kind == "glb" else None
    import trimesh

    try:
        scene = trimesh.load_scene(path if unpacked is None else BytesIO(unpacked), file_type=kind, process=False)
        meshes = _in_file_order(scene)
    except InputError:
        raise
    except Exception as error:  # trimesh raises whatever its parsers stumble over
        raise InputError(f"{path}: cannot be read as {kind.upper()} ({_first_line(error)}); export it again") from None
    parts = [part for node, T, mesh in meshes if isinstance(mesh, trimesh.Trimesh) for part in _node(node, mesh, T)]
    parts = [part for part in parts if len(part.faces)]
    if not parts:
        raise InputError(f"{path}: holds no triangles; proxnav needs a surface mesh, not points, curves or solids")
    _check_geometry(path, parts)
    return _uniquely_named(parts)


def _in_file_order(scene: Any) -> list[tuple[str, Float[np.ndarray, "4 4"], Any]]:
    """(geometry name, transform, mesh) of each node; the scene graph's own order and node names are partly random."""
    rank = {name: i for i, name in enumerate(scene.geometry)}
    nodes = [(str(name), np.asarray(T)) for T, name in (scene.graph[node] for node in scene.graph.nodes_geometry)]
    nodes.sort(key=lambda node: (rank[node[0]], node[1].ravel().tolist()))
    return [(name, T, scene.geometry[name]) for name, T in nodes]


def _node(node: str, mesh: Any, T: Float[np.ndarray, "4 4"]) -> list[FilePart]:
    """The node's triangles, split by tone when it has a base colour texture."""
    if np.ndim(mesh.vertices) != 2 or np.shape(mesh.vertices)[1] != 3:
        raise InputError(f"part '{node}' has vertices without three coordinates; export the mesh again")
    vertices = np.asarray(mesh.vertices, dtype=np.float64) @ T[:3, :3].T + T[:3, 3]
    faces = np.asarray(mesh.faces, dtype=np.int64)
    if np.linalg.det(T[:3, :3]) < 0:  # a mirroring node turns triangles inside out
        faces = faces[:, ::-1]
    tones: Tones = face_tones(mesh)
    names = [node] if len(tones.albedo) == 1 else [f"{node}_{i}" for i in range(len(tones.albedo))]
    return [
        FilePart(name, vertices, faces[tones.face_tone == i], _material(albedo, tones))
        for i, (name, albedo) in enumerate(zip(names, tones.albedo, strict=True))
    ]


def _material(albedo: Float[np.ndarray, "3"], tones: Tones) -> Material:
    kind = "metal" if tones.metallic > 0.5 else "plain"
    rgb = (float(albedo[0]), float(albedo[1]), float(albedo[2]))
    return Material(kind, rgb, tones.metallic, tones.roughness)


def _check_geometry(path: Path, parts: Sequence[FilePart]) -> None:
    if sum(len(part.faces) for part in parts) > MAX_ELEMENTS:
        raise InputError(f"{path}: more than {MAX_ELEMENTS} triangles; decimate it first")
    for part in parts:
        if part.faces.min() < 0 or part.faces.max() >= len(part.vertices):
            raise InputError(f"{path}: part '{part.name}' has a triangle that names a missing vertex")
        if not np.isfinite(part.vertices[part.faces]).all():
            raise InputError(f"{path}: part '{part.name}' has vertices that are not finite numbers")


def _uniquely_named(parts: Sequence[FilePart]) -> list[FilePart]:
    seen: dict[str, int] = {}
    unique = []
    for part in parts:
        name = re.sub(r"[^\w.-]+", "_", part.name)[:60] or "part"
        seen[name] = seen.get(name, 0) + 1
        name = name if seen[name] == 1 else f"{name}__{seen[name]}"
        unique.append(FilePart(name, part.vertices, part.faces, part.material))
    return unique


def _first_line(error: Exception) -> str:
    text = str(error).strip().splitlines()
    return f"{type(error).__name__}: {text[0][:120]}" if text else type(error).__name__
