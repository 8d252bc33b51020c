"""Messages between us and the Blender worker: a length, a JSON header, then the bytes of the arrays it lists.

Both ends import this file, worker.py under Blender's interpreter: nothing here may need more than numpy.
"""

import json
import struct
from collections.abc import Mapping
from typing import Any, BinaryIO

import numpy as np

MAGIC = b"\nPROXNAV-CYCLES-1\n"
"""Ends whatever Blender prints before the worker takes over its standard output."""

Arrays = dict[str, np.ndarray]
"""Arrays of any shape and type by name."""
Message = tuple[dict[str, Any], Arrays]
"""A header and its arrays."""


def write_message(stream: BinaryIO, header: Mapping[str, Any], arrays: Arrays) -> None:
    """Sends one message and flushes it."""
    arrays = {name: np.ascontiguousarray(array) for name, array in arrays.items()}
    entries = [{"name": name, "dtype": a.dtype.str, "shape": a.shape} for name, a in arrays.items()]
    text = json.dumps({**header, "arrays": entries}).encode()
    stream.write(struct.pack("<q", len(text)) + text)
    for array in arrays.values():
        stream.write(array.data)
    stream.flush()


def read_message(stream: BinaryIO) -> Message:
    """The next message; EOFError when the other end is gone."""
    header = json.loads(_exactly(stream, struct.unpack("<q", _exactly(stream, 8))[0]))
    arrays = {}
    for entry in header.pop("arrays"):
        dtype, shape = np.dtype(entry["dtype"]), tuple(entry["shape"])
        data = _exactly(stream, int(np.prod(shape, dtype=np.int64)) * dtype.itemsize)
        arrays[entry["name"]] = np.frombuffer(data, dtype).reshape(shape)
    return header, arrays


def skip_to_magic(stream: BinaryIO) -> None:
    """Reads past Blender's own start-up lines; EOFError when the worker never speaks."""
    seen = b""
    while not seen.endswith(MAGIC):
        seen = (seen + _exactly(stream, 1))[-len(MAGIC) :]


def _exactly(stream: BinaryIO, count: int) -> bytes:
    data = stream.read(count)
    if len(data) < count:
        raise EOFError("the Blender worker closed its pipe")
    return data
