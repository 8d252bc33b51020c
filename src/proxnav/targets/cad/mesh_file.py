"""Triangles and materials of a CAD or graphics file, node by node, in the file's own axes and unit."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.targets.cad.collada import collada_head
from proxnav.targets.cad.converted import step_as_glb, usd_as_glb
from proxnav.targets.cad.file_material import FileMaterial, file_material
from proxnav.targets.cad.mesh_guard import MAX_ELEMENTS, check_mesh_file
from proxnav.targets.cad.mesh_part import MeshPart
from proxnav.targets.cad.plain_glb import plain_glb
from proxnav.targets.surface.material import Material


@dataclass(frozen=True, slots=True, eq=False)
class FileMesh:
    """All that a file draws, in its own axes and unit."""

    parts: list[MeshPart]
    unit_m: float | None
    """Metres per unit as the file declares it; None where its format declares none."""
    up: str
    """File axis that points up, as the file declares it or as its format has it by custom."""
    forward: str

    def box(self) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
        """(lowest, highest) coordinates of what is drawn."""
        corners = [part.vertices[part.faces.ravel()] for part in self.parts]
        return np.min([c.min(axis=0) for c in corners], axis=0), np.max([c.max(axis=0) for c in corners], axis=0)

    def without(self, path: Path, names: Sequence[str]) -> "FileMesh":
        """The mesh less some parts; InputError for a part that `path` does not hold."""
        have = [part.name for part in self.parts]
        unknown = [name for name in names if name not in have]
        if unknown:
            raise InputError(f"{path}: no part '{unknown[0]}' to leave out; it has {', '.join(have[:20])}")
        kept = [part for part in self.parts if part.name not in names]
        if not kept:
            raise InputError(f"{path}: every part is left out")
        return replace(self, parts=kept)


_AXES = {"glb": "yz", "gltf": "yz", "obj": "yz", "stl": "zx", "ply": "zx", "step": "zx"}
"""Up and forward by custom of each format."""
_FORWARD = {"x": "y", "y": "z", "z": "x"}
"""Forward by custom for each axis that can point up."""


def read_mesh(path: Path) -> FileMesh:
    """All drawable nodes of a file, transforms applied; the names of the parts are unique."""
    kind = check_mesh_file(path)
    content, unit_m, up = None, None, _AXES.get(kind, "y")[0]
    if kind == "glb":
        content = plain_glb(path)
    elif kind == "dae":
        unit_m, up = collada_head(path)
    elif kind == "step":
        content, unit_m = step_as_glb(path)
    elif kind == "usd":
        content, unit_m, up = usd_as_glb(path)
    parts = _parts(path, kind, content)
    if kind == "step" and unit_m is not None:  # the converter writes metres
        parts = [replace(part, vertices=part.vertices / unit_m) for part in parts]
    return FileMesh(parts, unit_m, up, _AXES.get(kind, up + _FORWARD[up])[1])


def _parts(path: Path, kind: str, content: bytes | None) -> list[MeshPart]:
    """The parts of a file that trimesh reads, or of `content` in its place."""
    import trimesh

    try:
        source, file_type = (path, kind) if content is None else (BytesIO(content), "glb")
        scene = trimesh.load_scene(source, file_type=file_type, process=False)
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


def _node(node: str, mesh: Any, T: Float[np.ndarray, "4 4"]) -> list[MeshPart]:
    """The node's triangles, split by tone when its faces have colours of their own."""
    if np.ndim(mesh.vertices) != 2 or np.shape(mesh.vertices)[1] != 3:
        raise InputError(f"part '{node}' has vertices without three coordinates; export the mesh again")
    vertices = np.asarray(mesh.vertices, dtype=np.float64) @ T[:3, :3].T + T[:3, 3]
    faces = np.asarray(mesh.faces, dtype=np.int64)
    found = file_material(mesh)
    picture = found.picture
    if np.linalg.det(T[:3, :3]) < 0:  # a mirroring node turns triangles inside out
        faces = faces[:, ::-1]
        picture = None if picture is None else replace(picture, corner_uv=picture.corner_uv[:, ::-1])
    names = [node] if len(found.albedo) == 1 else [f"{node}_{i}" for i in range(len(found.albedo))]
    return [
        MeshPart(name, vertices, faces[found.face_tone == i], _material(albedo, found), picture)
        for i, (name, albedo) in enumerate(zip(names, found.albedo, strict=True))
    ]


def _material(albedo: Float[np.ndarray, "3"], found: FileMaterial) -> Material:
    kind = "metal" if found.metallic > 0.5 else "plain"
    rgb = (float(albedo[0]), float(albedo[1]), float(albedo[2]))
    return Material(kind, rgb, found.metallic, found.roughness)


def _check_geometry(path: Path, parts: Sequence[MeshPart]) -> None:
    if sum(len(part.faces) for part in parts) > MAX_ELEMENTS:
        raise InputError(f"{path}: more than {MAX_ELEMENTS} triangles; decimate it first")
    for part in parts:
        if part.faces.min() < 0 or part.faces.max() >= len(part.vertices):
            raise InputError(f"{path}: part '{part.name}' has a triangle that names a missing vertex")
        if not np.isfinite(part.vertices[part.faces]).all():
            raise InputError(f"{path}: part '{part.name}' has vertices that are not finite numbers")


def _uniquely_named(parts: Sequence[MeshPart]) -> list[MeshPart]:
    seen: dict[str, int] = {}
    unique = []
    for part in parts:
        name = re.sub(r"[^\w.-]+", "_", part.name)[:60] or "part"
        seen[name] = seen.get(name, 0) + 1
        unique.append(replace(part, name=name if seen[name] == 1 else f"{name}__{seen[name]}"))
    return unique


def _first_line(error: Exception) -> str:
    text = str(error).strip().splitlines()
    return f"{type(error).__name__}: {text[0][:120]}" if text else type(error).__name__
