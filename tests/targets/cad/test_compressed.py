"""GLB files with meshopt-compressed and quantised buffers: the same spacecraft, or one sentence."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import KDTree

from proxnav.errors import InputError
from proxnav.targets.cad.from_mesh import from_mesh
from proxnav.targets.cad.meshopt import decode, unfilter
from proxnav.targets.target import Target

DATA = Path(__file__).parents[2] / "data" / "targets"


def _middles(target: Target) -> np.ndarray:
    return target.vertices_m[target.faces].mean(axis=1)


@pytest.mark.parametrize("name", ["craft-meshopt.glb", "craft-quantised.glb"])
def test_a_compressed_file_is_the_same_spacecraft(name: str) -> None:
    """Encoded by gltf-transform, which stores 16 bits over 4 m."""
    plain, packed = from_mesh(DATA / "craft-plain.glb", unit_m=1.0), from_mesh(DATA / name, unit_m=1.0)
    assert packed.part_names == plain.part_names
    assert len(packed.faces) == len(plain.faces)
    assert [m.albedo for m in packed.materials] == [m.albedo for m in plain.materials]
    for a, b in ((plain, packed), (packed, plain)):
        assert KDTree(_middles(a)).query(_middles(b))[0].max() < 2e-4  # m


def test_deltas_of_the_extensions_own_example() -> None:
    """Appendix A: ten bytes in 4-bit sentinel coding are sixteen differences."""
    group = bytes([0x17, 0x5F, 0xF0, 0xBC, 0x77, 0xA9, 0x21, 0x00, 0x34, 0xB5])
    planes = bytes([2]) + group + bytes([0]) * 3  # the other three bytes of each element never change
    stream = bytes([0xA0]) + planes + bytes(32)
    decoded = decode(stream, "ATTRIBUTES", 16, 4).reshape(16, 4)
    deltas = np.array([-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0])
    np.testing.assert_array_equal(decoded[:, 0], np.cumsum(deltas).astype(np.uint8))
    assert not decoded[:, 1:].any()


def test_indices_by_hand() -> None:
    """Differences +5, +1, -3 to the first running value: zigzag 10, 2, 5, shifted for the bit that names the value."""
    stream = bytes([0xD1, 10 << 1, 2 << 1, 5 << 1]) + bytes(4)
    np.testing.assert_array_equal(decode(stream, "INDICES", 3, 4).view(np.uint32), [5, 6, 3])


@pytest.mark.parametrize(
    ("packed", "unit"), [((127, 0), (1, 0, 0)), ((0, -127), (0, -1, 0)), ((0, 0), (0, 0, 1)), ((127, 127), (0, 0, -1))]
)
def test_octahedral_directions_by_hand(packed: tuple[int, int], unit: tuple[int, int, int]) -> None:
    element = np.array([*packed, 127, 9], np.int8).view(np.uint8)
    decoded = unfilter(element, "OCTAHEDRAL", 4).view(np.int8)
    np.testing.assert_array_equal(decoded, [*(127 * np.array(unit)), 9])


def test_exponential_floats_by_hand() -> None:
    element = np.array([(-2 << 24) | 12], np.int32).view(np.uint8)
    assert unfilter(element, "EXPONENTIAL", 4).view(np.float32)[0] == 3.0  # 12 * 2^-2


def test_a_view_that_claims_more_than_its_stream_can_hold_is_refused(tmp_path: Path) -> None:
    content = (DATA / "craft-meshopt.glb").read_bytes()
    length = struct.unpack("<I", content[12:16])[0]
    tree = json.loads(content[20 : 20 + length])
    for count, stride, word in ((4_000_000_000, 2, "claims"), (15_000_000, 4, "refused"), (-1, 2, "whole numbers")):
        tree["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] |= {"count": count, "byteStride": stride}
        text = json.dumps(tree).encode()
        text += b" " * (-len(text) % 4)
        head = struct.pack("<4sIIII", b"glTF", 2, 0, len(text), 0x4E4F534A)
        (tmp_path / "liar.glb").write_bytes(head + text + content[20 + length :])
        with pytest.raises(InputError, match=word):
            from_mesh(tmp_path / "liar.glb", unit_m=1.0)


def test_an_extension_that_is_not_read_is_named_with_the_command_that_removes_it(tmp_path: Path) -> None:
    tree = {"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_draco_mesh_compression"]}
    (tmp_path / "a.gltf").write_text(json.dumps(tree))
    with pytest.raises(InputError, match=r"KHR_draco_mesh_compression.*gltf-transform copy in\.glb out\.glb"):
        from_mesh(tmp_path / "a.gltf")
    (tmp_path / "b.gltf").write_text(json.dumps(tree | {"extensionsRequired": ["EXT_meshopt_compression"]}))
    with pytest.raises(InputError, match=r"EXT_meshopt_compression.*one \.glb"):
        from_mesh(tmp_path / "b.gltf")


@settings(max_examples=200, deadline=None)
@given(place=st.integers(12, 4915), value=st.integers(0, 255), name=st.sampled_from(["meshopt", "quantised"]))
def test_any_changed_byte_is_a_target_or_a_sentence(tmp_path_factory, place: int, value: int, name: str) -> None:
    content = bytearray((DATA / f"craft-{name}.glb").read_bytes())
    content[place] = value
    path = tmp_path_factory.mktemp("m") / "a.glb"
    path.write_bytes(content)
    assert "\n" not in outcome(path)


def outcome(path: Path) -> str:
    """The target's name, or the sentence that refuses the file."""
    try:
        return from_mesh(path, length_m=4.0).name
    except InputError as error:
        return str(error)


@pytest.mark.parametrize("name", ["craft-meshopt.glb", "craft-plain.glb"])
def test_an_animation_that_nobody_can_decode_is_left_out(tmp_path: Path, name: str) -> None:
    """Its view claims a filter, its sampler an interpolation, of a later standard; the shape does not need them."""
    content = (DATA / name).read_bytes()
    length = struct.unpack("<I", content[12:16])[0]
    tree = json.loads(content[20 : 20 + length])
    strange = {"buffer": 0, "byteOffset": 0, "byteLength": 16, "byteStride": 16, "count": 1}
    packed = strange | {"mode": "ATTRIBUTES", "filter": "SPIRAL"}
    extensions = {"EXT_meshopt_compression": packed} if "meshopt" in name else {}
    tree["bufferViews"].append({"buffer": 0, "byteOffset": 0, "byteLength": 16, "extensions": extensions})
    view, number = len(tree["bufferViews"]) - 1, len(tree["accessors"])
    tree["accessors"] += [
        {"bufferView": view, "componentType": 5126, "type": kind, "count": 1} for kind in ("SCALAR", "VEC4")
    ]
    sampler = {"input": number, "output": number + 1, "interpolation": "BEZIER"}
    channel = {"sampler": 0, "target": {"node": 0, "path": "rotation"}}
    tree["animations"] = [{"samplers": [sampler], "channels": [channel]}]
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    rest = content[20 + length :]
    head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    (tmp_path / "moving.glb").write_bytes(head + text + rest)
    moving, still = (from_mesh(path, unit_m=1.0) for path in (tmp_path / "moving.glb", DATA / name))
    np.testing.assert_array_equal(moving.vertices_m, still.vertices_m)
