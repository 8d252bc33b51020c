"""Mesh files are not trusted: claims are checked against the file's size before anything is allocated for them."""

import json
import struct
from pathlib import Path
from typing import Any

from proxnav.errors import InputError
from proxnav.targets.cad.beside import check_inside
from proxnav.targets.cad.collada import check_collada
from proxnav.targets.cad.converted import check_step, check_usd
from proxnav.targets.cad.meshopt import MAX_INFLATION
from proxnav.targets.cad.plain_glb import MESHOPT, UNPACKED

FORMATS = ("GLB", "glTF", "STEP", "OBJ", "STL", "PLY", "DAE", "USD")
_SAME_AS = {"stp": "step", "usda": "usd", "usdc": "usd", "usdz": "usd"}
_INSTEAD = {
    "blend": "in Blender: File > Export > glTF 2.0, format glTF Binary (.glb)",
    "urdf": "it names the mesh of each link; give one of those, or export the assembled robot as one GLB",
    "fbx": "export it as GLB, for example from Blender: File > Export > glTF 2.0",
    "igs": "export it as STEP (AP214 or AP242)",
    "iges": "export it as STEP (AP214 or AP242)",
}  # fmt: skip
MAX_BYTES = 512 * 2**20
MAX_ELEMENTS = 20_000_000
"""Largest number of vertices or indices that a file may claim."""
_NEEDS_CONVERSION = {
    "KHR_draco_mesh_compression": "gltf-transform copy in.glb out.glb",
    "KHR_texture_basisu": "gltf-transform ktxdecompress in.glb out.glb",
}
_OTHERWISE = "an exporter without this extension"
_SAVE_AS_GLB = "saving it as one .glb file (compressed buffers are read from GLB alone)"
_READABLE = {
    "KHR_animation_pointer",
    "KHR_materials_pbrSpecularGlossiness",
    "EXT_texture_webp",
    "KHR_texture_transform",
    "KHR_materials_unlit",
}
_COMPONENT_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
_WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


def check_mesh_file(path: Path) -> str:
    """The file's type, one of the keys of `_CHECKS`; InputError when it should not be opened."""
    kind = path.suffix.lower().lstrip(".")
    kind = _SAME_AS.get(kind, kind)
    if kind not in _CHECKS:
        instead = _INSTEAD.get(kind, f"expected {', '.join(FORMATS)}")
        raise InputError(f"{path}: '{path.suffix}' is no mesh format that proxnav reads; {instead}")
    if not path.is_file():
        raise InputError(f"{path}: no such mesh file")
    size = path.stat().st_size
    if not 0 < size <= MAX_BYTES:
        raise InputError(f"{path}: {size} bytes; expected a mesh of 1 byte to {MAX_BYTES // 2**20} MiB")
    _CHECKS[kind](path, size)
    return kind


def _check_glb(path: Path, size: int) -> None:
    with path.open("rb") as file:
        head = file.read(20)
        if len(head) < 20 or head[:4] != b"glTF":
            raise InputError(f"{path}: not a binary glTF file (it does not begin with 'glTF')")
        version, _, length, kind = struct.unpack("<4I", head[4:])
        if version != 2 or kind != 0x4E4F534A or length > size - 20:
            raise InputError(f"{path}: broken glTF header (version {version}, first chunk of {length} of {size} bytes)")
        tree = _parsed(path, file.read(length))
        _check_gltf_tree(path, tree, size + _decoded_bytes(path, tree, size), UNPACKED)


def _check_gltf(path: Path, size: int) -> None:
    tree = _parsed(path, path.read_bytes())
    files = [u for u in _uris(tree) if not u.startswith("data:")]
    for uri in files:
        check_inside(path, uri)
    beside = [path.parent / uri for uri in files if (path.parent / uri).is_file()]
    _check_gltf_tree(path, tree, size + sum(file.stat().st_size for file in beside))


def _check_gltf_tree(path: Path, tree: dict[str, Any], available: int, unpacked: tuple[str, ...] = ()) -> None:
    """Extensions and counts; `available` bounds the bytes that accessors can really refer to."""
    readable = _READABLE | set(unpacked)
    missing = [str(name) for name in tree.get("extensionsRequired", []) if str(name) not in readable]
    if missing:
        how = _SAVE_AS_GLB if missing[0] in UNPACKED else _NEEDS_CONVERSION.get(missing[0], _OTHERWISE)
        raise InputError(f"{path}: needs the glTF extension {missing[0]}, which is not read here; convert with: {how}")
    for uri in _uris(tree):
        if not uri.startswith("data:"):
            check_inside(path, uri)
    for number, accessor in enumerate(tree.get("accessors", [])):
        _check_accessor(path, number, accessor, available)


def _decoded_bytes(path: Path, tree: dict[str, Any], size: int) -> int:
    """Bytes that the compressed views of a GLB unpack to; InputError where a claim cannot be true."""
    total = 0
    for number, view in enumerate(tree.get("bufferViews", [])):
        extensions = view.get("extensions") if isinstance(view, dict) else None
        packed = extensions.get(MESHOPT) if isinstance(extensions, dict) else None
        if packed is None:
            continue
        packed = packed if isinstance(packed, dict) else {}
        numbers = [packed.get(key, 0) for key in ("count", "byteStride", "byteLength", "byteOffset")]
        if not all(type(value) is int and value >= 0 for value in numbers):
            raise InputError(f"{path}: compressed view {number} has no count, stride and length in whole numbers")
        count, stride, length, offset = numbers
        allowed = (2, 4) if packed.get("mode") in ("TRIANGLES", "INDICES") else range(4, 257, 4)
        if stride not in allowed or count > MAX_ELEMENTS or offset + length > size:
            raise InputError(f"{path}: compressed view {number} claims {count} elements of {stride} bytes; broken file")
        if count * stride > MAX_INFLATION * (length + 64):
            raise InputError(f"{path}: compressed view {number} claims {count * stride} bytes out of {length}; refused")
        total += count * stride
    if total > MAX_BYTES:
        raise InputError(f"{path}: unpacks to {total} bytes; expected at most {MAX_BYTES // 2**20} MiB")
    return total


def _check_accessor(path: Path, number: int, accessor: Any, available: int) -> None:
    accessor = accessor if isinstance(accessor, dict) else {}
    count = accessor.get("count")
    width = _WIDTH.get(str(accessor.get("type")), 0) * _component_bytes(accessor.get("componentType"))
    if not isinstance(count, int) or not width or not 0 <= count <= MAX_ELEMENTS:
        raise InputError(f"{path}: accessor {number} claims {count!r} elements; expected 0 to {MAX_ELEMENTS}")
    if "bufferView" in accessor and count * width > available:
        raise InputError(f"{path}: accessor {number} claims {count} elements of {width} bytes in a file of {available}")


def _component_bytes(kind: Any) -> int:
    return _COMPONENT_BYTES.get(kind, 0) if isinstance(kind, int) else 0


def _uris(tree: dict[str, Any]) -> list[str]:
    entries = [e for key in ("buffers", "images") for e in tree.get(key, []) if isinstance(e, dict)]
    return [str(e["uri"]) for e in entries if "uri" in e]


def _parsed(path: Path, text: bytes) -> dict[str, Any]:
    try:
        tree = json.loads(text)
    except (ValueError, RecursionError):
        raise InputError(f"{path}: its glTF description is not JSON") from None
    lists = ("accessors", "buffers", "bufferViews", "images", "meshes", "extensionsRequired", "extensionsUsed")
    if not isinstance(tree, dict) or not all(isinstance(tree.get(key, []), list) for key in lists):
        raise InputError(f"{path}: its glTF description has a wrong layout")
    return tree


def _check_stl(path: Path, size: int) -> None:
    with path.open("rb") as file:
        head = file.read(84)
    if head[:5].lower() == b"solid" and b"\n" in head:
        return
    count = struct.unpack("<I", head[80:84])[0] if len(head) == 84 else -1
    if not 0 < count <= MAX_ELEMENTS or 84 + 50 * count > size:
        raise InputError(f"{path}: binary STL of {size} bytes claims {count} triangles; truncated, or not STL")


def _check_ply(path: Path, size: int) -> None:
    with path.open("rb") as file:
        head = file.read(min(size, 65536))
    end = head.find(b"end_header")
    if not head.startswith(b"ply") or end < 0:
        raise InputError(f"{path}: not a PLY file (no 'ply' ... 'end_header')")
    for line in head[:end].decode("ascii", "replace").splitlines():
        words = line.split()
        if words[:1] == ["element"]:
            count = int(words[2]) if len(words) == 3 and words[2].isdigit() and len(words[2]) < 12 else -1
            if not 0 <= count <= min(MAX_ELEMENTS, size):
                raise InputError(f"{path}: claims '{line.strip()[:60]}' in a file of {size} bytes")


def _check_obj(path: Path, size: int) -> None:
    with path.open("rb") as file:
        head = file.read(min(size, 4096))
    if b"\0" in head:
        raise InputError(f"{path}: not a text OBJ file")


_CHECKS = {
    "glb": _check_glb, "gltf": _check_gltf, "obj": _check_obj, "stl": _check_stl, "ply": _check_ply,
    "step": check_step, "dae": check_collada, "usd": check_usd,
}  # fmt: skip
