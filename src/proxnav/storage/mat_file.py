"""Numeric matrices of a MATLAB 5 file (`save -v6` and `-v7`), also those in structures, and nothing else of it.

Of our own because scipy's reader is native code that a damaged file can bring down with the whole process. Layout:
MathWorks, "MAT-File Format", level 5. A file is a head of 128 bytes and elements (type, bytes, data padded to 8); small
elements keep up to 4 bytes in their own head.
"""

import struct
import zlib
from collections.abc import Iterator

import numpy as np
from jaxtyping import Shaped

MAX_BYTES = 64 * 2**20
_MATRIX, _COMPRESSED = 14, 15
_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_NUMERIC_CLASSES = range(6, 16)  # double, single and the integers
_STRUCTURE, _DEEPEST = 2, 4  # structures within structures, that many levels of them
_COMPLEX = 0x08


def read_matrices(content: bytes) -> dict[str, Shaped[np.ndarray, "rows columns"]]:
    """Real two-dimensional numeric matrices by name, fields of structures as `structure.field`; ValueError where the
    bytes are no such file."""
    if len(content) < 136 or content[126:128] not in (b"IM", b"MI"):
        raise ValueError("no MATLAB 5 head")
    order = "<" if content[126:128] == b"IM" else ">"
    found = {}
    for kind, data in _elements(content[128:], order):
        if kind == _COMPRESSED:
            inner = list(_elements(_inflated(data), order))
            kind, data = inner[0] if inner else (0, b"")
        if kind == _MATRIX:
            found.update(_variable(data, order, "", 0))
    return found


def _variable(data: bytes, order: str, name: str, depth: int) -> Iterator[tuple[str, Shaped[np.ndarray, "r c"]]]:
    """(name, values) of a matrix, or of every matrix in a structure; `name` where the variable has none itself."""
    parts = list(_elements(data, order))
    if len(parts) < 3 or len(parts[0][1]) < 8:
        return
    (flags,) = struct.unpack(f"{order}I", parts[0][1][:4])
    name = name or parts[2][1].decode("latin-1")
    if flags & 0xFF != _STRUCTURE:
        if (matrix := _matrix(parts, flags, order)) is not None:
            yield name, matrix
    elif len(parts) > 4 and len(parts[3][1]) == 4 and depth < _DEEPEST:
        (width,) = struct.unpack(f"{order}i", parts[3][1])
        names = parts[4][1]
        fields = [names[i : i + width].split(b"\0")[0].decode("latin-1") for i in range(0, len(names), max(width, 1))]
        if len(parts) == 5 + len(fields):  # one structure, not an array of them
            for field, (kind, inner) in zip(fields, parts[5:], strict=True):
                if kind == _MATRIX:
                    yield from _variable(inner, order, f"{name}.{field}", depth + 1)


def _inflated(data: bytes) -> bytes:
    stream = zlib.decompressobj()
    try:
        out = stream.decompress(data, MAX_BYTES + 1)
    except zlib.error as error:
        raise ValueError(str(error)) from None
    if len(out) > MAX_BYTES:
        raise ValueError(f"a variable unpacks to more than {MAX_BYTES // 2**20} MiB")
    return out


def _elements(content: bytes, order: str) -> Iterator[tuple[int, bytes]]:
    place = 0
    while place + 8 <= len(content):
        kind, size = struct.unpack(f"{order}2I", content[place : place + 8])
        if kind >> 16:  # the small form: size and type share a word, the data is the next one
            kind, size, start, step = kind & 0xFFFF, kind >> 16, place + 4, 8
            if size > 4:
                raise ValueError("a small element of more than 4 bytes")
        else:
            start = place + 8
            step = 8 + (size if kind == _COMPRESSED else -(-size // 8) * 8)
        if start + size > len(content):
            raise ValueError("cut off within an element")
        yield kind, content[start : start + size]
        place += step


def _matrix(parts: list[tuple[int, bytes]], flags: int, order: str) -> Shaped[np.ndarray, "rows columns"] | None:
    """Values of a real two-dimensional numeric matrix, None for anything else."""
    if len(parts) < 4:
        return None
    dims = np.frombuffer(parts[1][1], f"{order}i4") if len(parts[1][1]) == 8 else np.empty(0, np.int32)
    kind, raw = parts[3]
    if flags & 0xFF not in _NUMERIC_CLASSES or (flags >> 8) & _COMPLEX or len(dims) != 2 or kind not in _TYPES:
        return None
    dtype = np.dtype(order + _TYPES[kind])
    rows, columns = (int(n) for n in dims)
    if min(rows, columns) < 0 or rows * columns * dtype.itemsize != len(raw):
        raise ValueError(f"a matrix of {rows} x {columns} in {len(raw)} bytes")
    return np.frombuffer(raw, dtype).reshape(rows, columns, order="F")
