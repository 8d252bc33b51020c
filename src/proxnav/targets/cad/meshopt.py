"""Decoders of EXT_meshopt_compression: attributes, triangles, index sequences, and the filters that meshes use.

Written from the ratified text of the extension (Khronos, glTF 2.0 vendor extensions), appendices A and B. A stream that
breaks its rules raises ValueError; what comes out has the size that was asked for.
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Int, UInt8

MAX_INFLATION = 64
"""Decoded over encoded size that no stream can exceed: 16 equal bytes cost two bits."""

Bytes = UInt8[np.ndarray, "_"]


def decode(data: bytes, mode: str, count: int, stride: int) -> Bytes:
    """`count` elements of `stride` bytes from a compressed stream."""
    stream = np.frombuffer(data, np.uint8)
    if mode == "ATTRIBUTES":
        return _attributes(stream, count, stride)
    indices = _triangles(stream, count) if mode == "TRIANGLES" else _sequence(stream, count)
    return np.array(indices, dtype=np.uint32).astype(np.uint16 if stride == 2 else np.uint32).view(np.uint8)


def unfilter(decoded: Bytes, filter: str, stride: int) -> Bytes:
    """Undoes the filter of attributes: OCTAHEDRAL for normals and tangents, EXPONENTIAL for floats."""
    if filter == "OCTAHEDRAL":
        return _octahedral(decoded.view(np.int8 if stride == 4 else np.int16)).view(np.uint8)
    if filter == "EXPONENTIAL":
        packed = decoded.view(np.int32)
        mantissa, exponent = (packed << 8) >> 8, packed >> 24
        return np.ldexp(mantissa.astype(np.float64), exponent).astype(np.float32).view(np.uint8)
    raise ValueError(f"filter {filter!r}")


def _attributes(stream: Bytes, count: int, stride: int) -> Bytes:
    """Mode 0: each byte of the elements apart, differences to the element before, 16 at a time."""
    tail = max(32, stride)
    if len(stream) < 1 + tail or stream[0] != 0xA0:
        raise ValueError("attribute stream of another version, or too short")
    out = np.empty((count, stride), np.uint8)
    last, place = stream[len(stream) - stride :].copy(), 1
    size = min((8192 // stride) & ~15, 256)
    for start in range(0, count, size):
        rows = min(size, count - start)
        deltas = np.empty((stride, rows), np.uint8)
        for byte in range(stride):
            deltas[byte], place = _plane(stream, place, rows)
        out[start : start + rows] = last + np.cumsum(deltas, axis=1, dtype=np.uint8).T
        last = out[start + rows - 1]
    return out.ravel()


def _plane(stream: Bytes, place: int, rows: int) -> tuple[Bytes, int]:
    """Differences of one byte of `rows` elements, and where the stream goes on."""
    groups = -(-rows // 16)
    head = stream[place : place + -(-groups // 4)]
    modes = (head[:, None] >> np.array([0, 2, 4, 6], np.uint8) & 3).ravel()[:groups]
    place += -(-groups // 4)
    codes = np.zeros((groups, 16), np.uint8)
    for group, mode in enumerate(modes.tolist()):
        if mode:
            codes[group], place = _group(stream, place, mode)
    flat = codes.ravel()[:rows]
    return (flat >> 1) ^ (~(flat & 1) + 1).astype(np.uint8), place


def _group(stream: Bytes, place: int, mode: int) -> tuple[Bytes, int]:
    """16 zigzag codes: 2 or 4 bits each with full bytes for what does not fit, or bytes."""
    if mode == 3:
        return _taken(stream, place, 16), place + 16
    packed = _taken(stream, place, 4 if mode == 1 else 8)
    shifts = np.array([6, 4, 2, 0] if mode == 1 else [4, 0], np.uint8)
    sentinel = 3 if mode == 1 else 15
    codes = ((packed[:, None] >> shifts) & sentinel).ravel().astype(np.uint8)
    place += len(packed)
    beyond = codes == sentinel
    codes[beyond] = _taken(stream, place, int(beyond.sum()))
    return codes, place + int(beyond.sum())


def _taken(stream: Bytes, place: int, n: int) -> Bytes:
    if place + n > len(stream):
        raise ValueError("attribute stream ends early")
    return stream[place : place + n]


def _triangles(stream: Bytes, count: int) -> list[int]:
    """Mode 1: a code per triangle that names recent edges and vertices, with more data where that is not enough."""
    n = count // 3
    if count % 3 or len(stream) < 1 + n + 16 or stream[0] != 0xE1:
        raise ValueError("triangle stream of another version, or too short")
    codes, table = stream[1 : 1 + n].tolist(), stream[-16:].tolist()
    state = _Recent(stream[1 + n : -16].tobytes())
    for code in codes:
        high, low = code >> 4, code & 15
        if high < 15:
            state.with_edge(high, low)
        else:
            state.without_edge(low, table)
    return state.out


class _Recent:
    """What the decoder of triangles remembers: the last 16 edges and vertices, the next new vertex, the last index."""

    def __init__(self, data: bytes) -> None:
        self.data = iter(data)
        self.edges = [(0, 0)] * 16
        self.vertices = [0] * 16
        self.next = self.last = 0
        self.out: list[int] = []

    def with_edge(self, edge: int, low: int) -> None:
        """Cases 0xX0 to 0xXf: a recent edge and one more vertex."""
        a, b = self.edges[edge]
        c = self.new() if low == 0 else self.vertices[low] if low < 13 else self.near(low)
        if low == 0 or low >= 13:
            self.vertices = [c, *self.vertices[:15]]
        self.edges = [(a, c), (c, b), *self.edges[:14]]
        self.out += (a, b, c)

    def near(self, low: int) -> int:
        """A vertex beside the last one, or one written out."""
        if low == 15:
            return self.explicit()
        self.last = (self.last + (1 if low == 14 else -1)) & 0xFFFFFFFF
        return self.last

    def without_edge(self, low: int, table: list[int]) -> None:
        """Cases 0xfY: three vertices, by table or written out."""
        code = table[low] if low < 14 else self.byte()
        if low >= 14 and code == 0:
            self.next = 0
        z, w = code >> 4, code & 15
        a = self.explicit() if low == 15 else self.new()
        recent = self.vertices
        b = self.choose(z, recent)
        c = self.choose(w, recent)
        fresh = [a, *([b] if z in (0, 15) else []), *([c] if w in (0, 15) else [])]
        self.vertices = [*reversed(fresh), *self.vertices][:16]
        self.edges = [(a, c), (c, b), (b, a), *self.edges[:13]]
        self.out += (a, b, c)

    def choose(self, nibble: int, recent: list[int]) -> int:
        """The next new vertex, a recent one, or one written out."""
        return self.new() if nibble == 0 else self.explicit() if nibble == 15 else recent[nibble - 1]

    def new(self) -> int:
        """The next vertex that was not seen before."""
        self.next += 1
        return self.next - 1

    def byte(self) -> int:
        """One byte of the data."""
        value = next(self.data, None)
        if value is None:
            raise ValueError("triangle stream ends early")
        return value

    def explicit(self) -> int:
        """A vertex as zigzag difference to the last one written out."""
        code = _varint(self.data)
        self.last = (self.last + ((code >> 1) ^ -(code & 1))) & 0xFFFFFFFF
        return self.last


def _sequence(stream: Bytes, count: int) -> list[int]:
    """Mode 2: differences to one of two running values."""
    if len(stream) < 1 + count + 4 or stream[0] != 0xD1:
        raise ValueError("index stream of another version, or too short")
    data, last, out = iter(stream[1:-4].tobytes()), [0, 0], []
    for _ in range(count):
        code = _varint(data)
        delta = (code >> 2) ^ -((code >> 1) & 1)
        last[code & 1] = (last[code & 1] + delta) & 0xFFFFFFFF
        out.append(last[code & 1])
    return out


def _varint(data: Iterator[int]) -> int:
    value = shift = 0
    while shift < 35:
        byte = next(data, None)
        if byte is None:
            raise ValueError("stream ends inside a number")
        value |= (byte & 127) << shift
        if byte < 128:
            return value & 0xFFFFFFFF
        shift += 7
    raise ValueError("a number of more than five bytes")


def _octahedral(packed: Int[np.ndarray, "n"]) -> Int[np.ndarray, "n"]:
    """Unit vectors as normalised integers; the fourth component passes unchanged."""
    rows = packed.reshape(-1, 4)
    top = np.iinfo(packed.dtype).max
    one = np.maximum(rows[:, 2:3].astype(np.float64), 1.0)
    xy = rows[:, :2] / one
    z = 1.0 - np.abs(xy).sum(axis=1, keepdims=True)
    xyz = np.concatenate([xy - np.copysign(np.minimum(z, 0.0), xy), z], axis=1)
    length = np.maximum(np.linalg.norm(xyz, axis=1, keepdims=True), 1e-12)
    return np.concatenate([np.round(xyz / length * top).astype(packed.dtype), rows[:, 3:]], axis=1).ravel()
