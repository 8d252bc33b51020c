"""A GLB whose buffers are compressed (meshopt) or quantised, as one that any reader takes."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.errors import InputError
from proxnav.targets.cad.meshopt import decode, unfilter

MESHOPT, QUANTISED = "EXT_meshopt_compression", "KHR_mesh_quantization"
UNPACKED = (MESHOPT, QUANTISED)
"""Extensions that are undone here."""
_DTYPES = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_GEOMETRY = ("POSITION", "NORMAL", "TANGENT", "TEXCOORD_0", "TEXCOORD_1")


def plain_glb(path: Path) -> bytes | None:
    """The file without those extensions; None where it uses none of them. Counts must have been checked before."""
    tree, binary = _chunks(path.read_bytes())
    used = set(tree.get("extensionsRequired", [])) | set(tree.get("extensionsUsed", []))
    if not used & set(UNPACKED):
        return None
    try:
        parts = [binary + b"\0" * (-len(binary) % 4)]
        _keep_still(tree)
        _decode_views(tree, binary, parts)
        _dequantise(tree, parts)
    except InputError:
        raise
    except (ValueError, KeyError, IndexError, TypeError, OverflowError) as error:
        raise InputError(f"{path}: its compressed buffers cannot be decoded ({error}); export it again") from None
    for key in ("extensionsRequired", "extensionsUsed"):
        tree[key] = [name for name in tree.get(key, []) if name not in UNPACKED]
        if not tree[key]:
            del tree[key]
    body = b"".join(parts)
    tree["buffers"] = [{"byteLength": len(body)}]
    return _packed(tree, body)


def _keep_still(tree: dict[str, Any]) -> None:
    """Drops what moves: animations, skins and morph targets, and the data that only they use, whatever codes them."""
    primitives = [p for mesh in tree.get("meshes", []) for p in mesh.get("primitives", [])]
    drawn = {number for p in primitives for number in (*p.get("attributes", {}).values(), p.get("indices"))}
    for p in primitives:
        p.pop("targets", None)
    for key in ("animations", "skins"):
        tree.pop(key, None)
    accessors = tree.get("accessors", [])
    for number in range(len(accessors)):
        if number not in drawn:
            accessors[number] = {"componentType": 5126, "type": "SCALAR", "count": 1}
    used = {accessor.get("bufferView") for accessor in accessors} | {
        i.get("bufferView") for i in tree.get("images", [])
    }
    for number, view in enumerate(tree.get("bufferViews", [])):
        if number not in used:
            view.clear()
            view |= {"buffer": 0, "byteOffset": 0, "byteLength": 0}


def _decode_views(tree: dict[str, Any], binary: bytes, parts: list[bytes]) -> None:
    """Every compressed view points to its decoded bytes, which are appended; others stay where they are."""
    for view in tree.get("bufferViews", []):
        packed = view.get("extensions", {}).pop(MESHOPT, None)
        if packed is None:
            if view.get("buffer", 0) != 0:
                raise ValueError("a plain view lies outside the GLB's own buffer")
            continue
        if packed.get("buffer", 0) != 0:
            raise ValueError("compressed data lie outside the GLB's own buffer")
        start = int(packed.get("byteOffset", 0))
        data = binary[start : start + int(packed["byteLength"])]
        count, stride = int(packed["count"]), int(packed["byteStride"])
        decoded = decode(data, packed["mode"], count, stride)
        if packed.get("filter", "NONE") != "NONE":
            decoded = unfilter(decoded, packed["filter"], stride)
        view |= {"buffer": 0, "byteOffset": sum(map(len, parts)), "byteLength": decoded.nbytes}
        parts.append(decoded.tobytes() + b"\0" * (-decoded.nbytes % 4))


def _dequantise(tree: dict[str, Any], parts: list[bytes]) -> None:
    """Vertex data in integers become float32, each accessor in a view of its own."""
    body, done = b"".join(parts), set()
    for mesh in tree.get("meshes", []):
        for primitive in mesh.get("primitives", []):
            for name in _GEOMETRY:
                number = primitive.get("attributes", {}).get(name)
                if number is None or number in done:
                    continue
                done.add(number)
                accessor = tree["accessors"][number]
                if accessor["componentType"] != 5126 and "bufferView" in accessor:
                    _as_float(tree, accessor, body, parts)


def _as_float(tree: dict[str, Any], accessor: dict[str, Any], body: bytes, parts: list[bytes]) -> None:
    dtype, width, count = _DTYPES[accessor["componentType"]], _WIDTHS[accessor["type"]], int(accessor["count"])
    view = tree["bufferViews"][accessor["bufferView"]]
    size = np.dtype(dtype).itemsize * width
    stride = int(view.get("byteStride", size))
    start = int(view.get("byteOffset", 0)) + int(accessor.get("byteOffset", 0))
    if count < 1 or start < 0 or stride < size or start + stride * (count - 1) + size > len(body):
        raise ValueError("an accessor reaches beyond its buffer")
    raw = np.ndarray((count, width), dtype, body, start, (stride, np.dtype(dtype).itemsize))
    values = raw.astype(np.float32)
    if accessor.pop("normalized", False):
        values = np.maximum(values / np.iinfo(dtype).max, -1.0).astype(np.float32)
    offset = sum(map(len, parts))
    parts.append(values.tobytes())
    tree["bufferViews"].append({"buffer": 0, "byteOffset": offset, "byteLength": values.nbytes})
    accessor |= {"bufferView": len(tree["bufferViews"]) - 1, "byteOffset": 0, "componentType": 5126,
                 "min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}  # fmt: skip


def _chunks(content: bytes) -> tuple[dict[str, Any], bytes]:
    """(description, binary chunk)."""
    length = struct.unpack("<I", content[12:16])[0]
    tree = json.loads(content[20 : 20 + length])
    rest = content[20 + length :]
    if len(rest) < 8:
        return tree, b""
    return tree, rest[8 : 8 + struct.unpack("<I", rest[:4])[0]]


def _packed(tree: dict[str, Any], body: bytes) -> bytes:
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    body += b"\0" * (-len(body) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(body))
    return b"".join(
        [head, struct.pack("<I4s", len(text), b"JSON"), text, struct.pack("<I4s", len(body), b"BIN\0"), body]
    )
