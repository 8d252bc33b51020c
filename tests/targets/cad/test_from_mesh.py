"""Targets from mesh files: scale, axes, parts, and files that lie."""

import contextlib
import json
import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.targets.mesh_files import craft

from proxnav.errors import InputError
from proxnav.targets.cad.axes import R_target_file
from proxnav.targets.cad.from_mesh import from_mesh, isolated_parts
from proxnav.targets.loading import load_target


def test_scale_axes_and_parts_of_a_glb(glb: Path):
    target = from_mesh(glb, unit_m=2.0)
    np.testing.assert_allclose(np.ptp(target.vertices_m, axis=0), [4.0, 6.0, 6.0], atol=1e-5)  # m: x, y, z of the file
    assert target.part_names == ("body", "mast")
    assert target.materials[0].kind == "metal"
    np.testing.assert_allclose(target.materials[0].albedo, [0.2, 0.4, 0.6], atol=2e-3)
    mast = target.vertices_m[target.faces[target.face_part == 1].ravel()]
    assert mast[:, 1].max() == pytest.approx(5.0, abs=1e-5)  # its tip is up
    assert "1 unit = 2 m" in target.source


def test_true_length_gives_the_scale(glb: Path):
    target = from_mesh(glb, length_m=12.0)
    assert np.ptp(target.vertices_m, axis=0).max() == pytest.approx(12.0, abs=1e-5)


def test_triangles_of_a_mirrored_node_still_face_outward(tmp_path: Path):
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.icosphere(subdivisions=2), transform=np.diag([-1.0, 1.0, 1.0, 1.0]))
    scene.export(tmp_path / "m.glb")
    target = from_mesh(tmp_path / "m.glb", unit_m=1.0)
    assert trimesh.Trimesh(target.vertices_m, target.faces).volume > 0


@pytest.mark.parametrize("suffix", ["obj", "stl", "ply"])
def test_other_formats_give_the_same_shape(tmp_path: Path, suffix: str):
    mesh = craft().to_geometry()
    mesh.export(tmp_path / f"craft.{suffix}")
    target = from_mesh(tmp_path / f"craft.{suffix}", unit_m=1.0, up="y", forward="z")
    np.testing.assert_allclose(np.ptp(target.vertices_m, axis=0), [3.0, 2.0, 3.0], atol=1e-4)


def test_colours_of_faces_are_split_into_their_tones(tmp_path: Path):
    mesh = trimesh.creation.icosphere(subdivisions=2)
    mesh.visual.face_colors = np.where(mesh.triangles_center[:, :1] > 0, [[230, 230, 230, 255]], [[30, 30, 30, 255]])
    mesh.export(tmp_path / "two.ply")
    tones = [m.albedo[0] for m in from_mesh(tmp_path / "two.ply", unit_m=1.0).materials]
    assert min(tones) == pytest.approx(((30 / 255 + 0.055) / 1.055) ** 2.4, abs=0.01)
    assert max(tones) == pytest.approx(((230 / 255 + 0.055) / 1.055) ** 2.4, abs=0.02)


def test_axes_of_common_formats_lead_to_forward_right_down():
    for up, forward in (("y", "z"), ("z", "x"), ("-x", "y")):
        R = R_target_file(up, forward)
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(R) == pytest.approx(1.0)
    with pytest.raises(InputError, match="one axis"):
        R_target_file("y", "-y")
    with pytest.raises(InputError, match="'w'"):
        R_target_file("w", "x")


def test_hubble_is_upright_and_an_inch_is_its_unit(shared_data: Path):
    target = from_mesh(shared_data / "models" / "hubble_plain.glb", length_m=13.2, up="y", forward="z")
    size = np.ptp(target.vertices_m, axis=0)
    assert int(np.argmax(size)) == 2  # the tube is vertical
    unit = float(target.source.split("= ")[1].split(" ")[0])
    assert unit == pytest.approx(0.0254, rel=0.02)
    assert max(m.albedo[0] for m in target.materials) > 3 * min(m.albedo[0] for m in target.materials)


def test_iss_has_its_truss_and_its_leftovers_are_named(shared_data: Path):
    path = shared_data / "models" / "iss_plain.glb"
    whole = from_mesh(path, length_m=109.0)
    leftovers = isolated_parts(whole)
    assert len(leftovers) == 7
    clean = from_mesh(path, length_m=109.0, up="-x", forward="y", without=leftovers)
    np.testing.assert_allclose(np.ptp(clean.vertices_m, axis=0), [71.7, 109.0, 14.6], atol=0.1)  # m
    assert not isolated_parts(clean)


def test_unit_that_makes_no_spacecraft_is_refused_with_guesses(shared_data: Path):
    with pytest.raises(InputError, match=r"525\.5 units would be 525\.5 m.*in: 13\.3 m"):
        load_target(str(shared_data / "models" / "hubble_plain.glb"))


def rewritten(glb: Path, change) -> Path:
    """The GLB with its description changed."""
    data = glb.read_bytes()
    (length,) = struct.unpack("<I", data[12:16])
    tree = json.loads(data[20 : 20 + length])
    change(tree)
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    head = struct.pack("<4s2I2I", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    bad = glb.with_name("bad.glb")
    bad.write_bytes(head + text + rest)
    return bad


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda t: t["accessors"][0].update(count=4_000_000_000), "claims 4000000000 elements"),
        (lambda t: t["accessors"][0].update(count=1_000_000), "in a file of"),
        (lambda t: t["accessors"][0].update(count=-1), "claims -1"),
        (
            lambda t: t.update(extensionsRequired=["KHR_draco_mesh_compression"]),
            "KHR_draco.*gltf-transform",
        ),
        (lambda t: t.update(extensionsRequired=["VENDOR_secret"]), "VENDOR_secret"),
        (lambda t: t["buffers"][0].update(uri="../../../etc/passwd"), "outside its folder"),
        (lambda t: t["buffers"][0].update(uri="https://example.org/a.bin"), "outside its folder"),
        (lambda t: t.update(accessors=7), "wrong layout"),
        (lambda t: t.update(meshes=[], nodes=[], scenes=[{"nodes": []}]), "no triangles|cannot be read"),
    ],
)
def test_glb_that_lies_is_refused_in_one_sentence(glb: Path, change, says: str):
    with pytest.raises(InputError, match=says):
        from_mesh(rewritten(glb, change), unit_m=1.0)


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.glb", b"glTF", "not a binary glTF"),
        ("a.stl", b"\0" * 80 + struct.pack("<I", 4_000_000_000), "claims 4000000000 triangles"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 4000000000\nend_header\n", "element vertex 4000000000"),
        ("a.ply", b"plain text", "not a PLY"),
        ("a.obj", b"v 0 0 0\0\0", "not a text OBJ"),
        ("a.obj", b"hello\n", "no triangles|cannot be read"),
        ("a.obj", b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
        ("a.docx", b"PK", "no mesh format.*expected GLB, glTF, STEP"),
        ("a.stl", b"", "0 bytes"),
    ],
)
def test_broken_files_are_refused_in_one_sentence(tmp_path: Path, name: str, content: bytes, says: str):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=says):
        from_mesh(tmp_path / name, unit_m=1.0)


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(at=st.integers(0, 5000), value=st.binary(min_size=1, max_size=4))
def test_damaged_glb_gives_a_target_or_our_own_error(glb: Path, at: int, value: bytes):
    data = bytearray(glb.read_bytes())
    at %= len(data)
    data[at : at + len(value)] = value
    bad = glb.with_name("damaged.glb")
    bad.write_bytes(bytes(data))
    with contextlib.suppress(InputError):
        assert np.isfinite(from_mesh(bad, unit_m=1.0).corner_normals).all()
