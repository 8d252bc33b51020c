"""The content of a calibration file as nested mappings, whatever it is written in: JSON, YAML, XML, npz or MATLAB."""

import json
import zipfile
import zlib
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from proxnav.errors import InputError
from proxnav.storage.mat_file import read_matrices

_MOST_TEXT, _MOST_BYTES = 2**20, 64 * 2**20
_MOST_ARRAY = 2**16
"""Bytes of an array that can be part of a camera; npz files also hold the views that it was calibrated from."""


def read_document(path: Path) -> Mapping[str, Any]:
    """The mapping that a file holds; InputError where it holds none, or is none of these formats."""
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise InputError(f"{path}: larger than {_MOST_BYTES // 2**20} MiB, which no calibration file is")
        content = path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; give a calibration file of the camera") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); give a calibration file of the camera") from None
    try:
        found = _parsed(content)
    except (ValueError, RecursionError, KeyError, EOFError, zipfile.BadZipFile, zlib.error, NotImplementedError) as why:
        reason = str(why).splitlines()[0][:120] if str(why) else type(why).__name__
        raise InputError(f"{path}: not readable as JSON, YAML, XML, npz or MATLAB 5 ({reason})") from None
    if not isinstance(found, Mapping):
        raise InputError(f"{path}: holds no named values, found {type(found).__name__}; a camera needs names")
    return found


def _parsed(content: bytes) -> Any:
    if content[:4] == b"PK\x03\x04":
        return _npz(content)
    if content[:6] == b"MATLAB":
        if content[126:128] not in (b"IM", b"MI") or content[124:126] in (b"\x00\x02", b"\x02\x00"):
            raise ValueError("MATLAB 7.3; save with -v7")
        return _nested(read_matrices(content))
    if content[:6] == b"\x93NUMPY":
        raise ValueError("a bare array; save an npz with K, dist, width and height")
    if len(content) > _MOST_TEXT:
        raise ValueError(f"text of more than {_MOST_TEXT // 2**20} MiB")
    text = content.decode("utf-8-sig").lstrip()
    if text.startswith("<"):
        return _xml(text)
    return json.loads(text) if text.startswith(("{", "[")) else _yaml(text)


def _npz(content: bytes) -> dict[str, Any]:
    found = {}
    with zipfile.ZipFile(BytesIO(content)) as archive:
        for entry in archive.infolist():
            if entry.filename.endswith(".npy") and entry.file_size <= _MOST_ARRAY and not entry.flag_bits & 1:
                with archive.open(entry) as member:
                    found[entry.filename[:-4]] = np.lib.format.read_array(BytesIO(member.read()), allow_pickle=False)
    return found


def _nested(flat: Mapping[str, Any]) -> dict[str, Any]:
    """Names such as `params.K` as structures."""
    out: dict[str, Any] = {}
    for name, value in flat.items():
        *above, last = name.split(".")
        place = out
        for part in above:
            place = place.setdefault(part, {})
        place[last] = value
    return out


def _xml(text: str) -> Any:
    """OpenCV's FileStorage: elements with text, or with rows, cols and data."""
    if "<!" in text.replace("<!--", ""):
        raise ValueError("XML with a document type")
    try:
        return _element(ElementTree.fromstring(text))
    except ElementTree.ParseError as error:
        raise ValueError(str(error)) from None


def _element(node: ElementTree.Element) -> Any:
    if len(node):
        return {child.tag: _element(child) for child in node}
    words = (node.text or "").split()
    return words if node.tag == "data" or len(words) > 1 else words[0] if words else ""


def _yaml(text: str) -> Any:
    """YAML of any version; OpenCV's own begins with a directive that no other reader takes."""
    import yaml

    class Loader(yaml.SafeLoader):
        """Plain values only, with OpenCV's matrices as mappings."""

    def matrix(loader: yaml.SafeLoader, node: yaml.Node) -> dict[Any, Any]:
        return loader.construct_mapping(node, deep=True)  # pyright: ignore[reportArgumentType] - refuses other nodes

    Loader.add_constructor("tag:yaml.org,2002:opencv-matrix", matrix)
    lines = [line for line in text.splitlines() if not line.startswith("%")]
    try:
        return Loader("\n".join(lines)).get_single_data()
    except yaml.YAMLError as error:
        raise ValueError(" ".join(str(error).split())) from None
