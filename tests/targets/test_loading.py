"""Targets from files: scale, axes, materials, exact round trips, and files that lie."""

import contextlib
import json
import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from proxnav.errors import InputError
from proxnav.targets.cad.axes import R_target_file
from proxnav.targets.cad.from_mesh import from_mesh, isolated_parts
from proxnav.targets.keypoints.choice import near_symmetries, seen_share, sharpness
from proxnav.targets.keypoints.point_files import load_points
from proxnav.targets.loading import load_target, save_target
from proxnav.targets.space_rider import space_rider
from proxnav.targets.target import Target


def craft() -> trimesh.Scene:
    """A body 2 x 1 x 3 units (y up) with a mast on one side, in a scene whose nodes are moved."""
    scene = trimesh.Scene()
    grey = PBRMaterial(baseColorFactor=[0.2, 0.4, 0.6, 1.0], metallicFactor=1.0, roughnessFactor=0.3)
    body = trimesh.creation.box((2, 1, 3)).subdivide()
    body.visual = TextureVisuals(material=grey, uv=np.zeros((len(body.vertices), 2)))
    scene.add_geometry(body, geom_name="body", transform=np.diag([1.0, 1, 1, 1]))
    mast = trimesh.creation.cylinder(0.1, 2.0, sections=8)
    turn = np.array([[1.0, 0, 0, 0.8], [0, 0, -1, 1.5], [0, 1, 0, 1.0], [0, 0, 0, 1]])
    scene.add_geometry(mast, geom_name="mast", transform=turn)
    return scene


@pytest.fixture
def glb(tmp_path: Path) -> Path:
    path = tmp_path / "craft.glb"
    craft().export(path)
    return path


def same(a: Target, b: Target) -> bool:
    arrays = ("vertices_m", "faces", "face_part", "corner_normals", "corner_uv_m", "keypoints_m")
    values = ("name", "part_names", "materials", "keypoint_names", "licence", "source")
    exact = all(np.array_equal(getattr(a, k), getattr(b, k)) for k in arrays)
    return exact and all(getattr(a, k) == getattr(b, k) for k in values) and dict(a.subsets) == dict(b.subsets)


def test_scale_axes_and_parts_of_a_glb(glb: Path):
    target = from_mesh(glb, unit_m=2.0)
    np.testing.assert_allclose(np.ptp(target.vertices_m, axis=0), [6.0, 4.0, 6.0], atol=1e-5)  # m: forward, right, down
    np.testing.assert_allclose(target.vertices_m.min(axis=0), -target.vertices_m.max(axis=0), atol=1e-5)
    assert target.part_names == ("body", "mast")
    assert target.materials[0].kind == "metal"
    np.testing.assert_allclose(target.materials[0].albedo, [0.2, 0.4, 0.6], atol=2e-3)
    mast = target.vertices_m[target.faces[target.face_part == 1].ravel()]
    assert mast[:, 2].min() == pytest.approx(-3.0, abs=1e-5)  # its tip is up
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


def test_texture_is_split_into_its_tones(tmp_path: Path):
    from PIL import Image

    image = Image.fromarray(np.repeat(np.array([[[30, 30, 30], [230, 230, 230]]], np.uint8), 2, axis=0))
    mesh = trimesh.creation.icosphere(subdivisions=2)
    uv = np.column_stack([np.where(mesh.vertices[:, 0] > 0, 0.75, 0.25), np.full(len(mesh.vertices), 0.5)])
    white = PBRMaterial(baseColorTexture=image, baseColorFactor=[1.0, 1, 1, 1], metallicFactor=0.0)
    mesh.visual = TextureVisuals(uv=uv, material=white)
    mesh.export(tmp_path / "two.glb")
    target = from_mesh(tmp_path / "two.glb", unit_m=1.0)
    tones = [m.albedo[0] for m in target.materials]
    assert min(tones) == pytest.approx(((30 / 255 + 0.055) / 1.055) ** 2.4, abs=0.01)
    assert max(tones) == pytest.approx(((230 / 255 + 0.055) / 1.055) ** 2.4, abs=0.02)


def test_saving_and_loading_gives_back_every_number(tmp_path: Path, glb: Path):
    for target in (space_rider(), from_mesh(glb, unit_m=1.0)):
        save_target(target, tmp_path / target.name)
        assert same(target, load_target(str(tmp_path / target.name)))
        assert same(target, load_target(str(tmp_path / target.name / "target.json")))


def test_same_file_gives_the_same_object_until_it_changes(tmp_path: Path):
    save_target(space_rider(), tmp_path)
    first = load_target(str(tmp_path))
    assert load_target(str(tmp_path)) is first
    assert load_target("space-rider") is load_target("space-rider")


def test_suggested_keypoints_are_sharp_often_seen_and_apart(glb: Path):
    target = from_mesh(glb, unit_m=1.0)
    assert len(target.keypoint_names) == 24
    assert seen_share(target, target.keypoints_m).min() >= 0.12
    gaps = np.linalg.norm(target.keypoints_m[:, None] - target.keypoints_m[None], axis=2)
    assert gaps[~np.eye(24, dtype=bool)].min() > 0.05  # m
    six = target.with_subset("six").keypoints_m
    assert np.linalg.svd(six - six.mean(axis=0), compute_uv=False)[2] > 0.3  # m, not coplanar


def test_sharpness_of_a_cube_is_that_of_three_faces():
    cube = trimesh.creation.box((1, 1, 1))
    score = sharpness(np.asarray(cube.vertices, float), np.asarray(cube.faces))
    assert score.min() > 0.15
    sphere = trimesh.creation.icosphere(subdivisions=3)
    assert sharpness(np.asarray(sphere.vertices, float), np.asarray(sphere.faces)).max() < 0.02


def test_corners_of_a_thin_plate_are_as_sharp_as_those_of_a_cube():
    """1 - 1/sqrt(3) however the faces are cut into triangles: a corner's three faces each have 90 deg there."""
    for extents in ((0.15, 0.7, 0.01), (0.7, 0.01, 0.15), (1.0, 1.0, 1.0)):  # m
        plate = trimesh.creation.box(extents)
        score = sharpness(np.asarray(plate.vertices, float), np.asarray(plate.faces))
        np.testing.assert_allclose(score, 1.0 - 1.0 / np.sqrt(3.0), atol=1e-9)


def test_symmetry_of_a_plain_box_is_reported_and_space_riders_is_not(tmp_path: Path, rng: np.random.Generator):
    trimesh.creation.box((1, 2, 4)).subdivide().subdivide().export(tmp_path / "box.stl")
    turns = near_symmetries(from_mesh(tmp_path / "box.stl", unit_m=1.0), rng)
    assert sum(turn.angle_deg == 180 for turn in turns) == 3
    assert not near_symmetries(space_rider(), rng)


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
    target = from_mesh(shared_data / "models" / "hubble_plain.glb", length_m=13.2)
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


def test_unknown_names_are_refused(glb: Path):
    with pytest.raises(InputError, match="space-rider"):
        load_target("space-ridder")
    with pytest.raises(InputError, match="body, mast"):
        from_mesh(glb, without=["door"])
    with pytest.raises(InputError, match="not both"):
        from_mesh(glb, unit_m=1.0, length_m=2.0)


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
        ("a.step", b"ISO-10303-21;", "no mesh format"),
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


def test_target_json_that_lies_is_refused(tmp_path: Path):
    path = save_target(space_rider(), tmp_path)
    good = json.loads(path.read_text())
    for change, says in (
        ({"version": 9}, "version 1"),
        ({"mesh": "../secret.npz"}, "mesh.npz"),
        ({"parts": good["parts"][:3]}, "face_part"),
        ({"keypoints_m": [[0, 0]]}, "malformed|shape"),
        ({"subsets": {"six": [99]}}, "subsets"),
        ({"parts": [p | {"kind": "velvet"} for p in good["parts"]]}, "velvet"),
    ):
        path.write_text(json.dumps(good | change))
        with pytest.raises(InputError, match=says):
            load_target(str(path))
    path.write_text(json.dumps(good))
    (tmp_path / "mesh.npz").write_bytes(b"PK nothing")
    with pytest.raises(InputError, match="not a readable mesh"):
        load_target(str(path.parent))


def test_tango_points_come_from_the_published_mat(shared_data: Path):
    points, names = load_points(shared_data / "speedplus" / "tangoPoints.mat")
    assert points.shape == (11, 3)
    assert names[:2] == ("p00", "p01")
    assert np.abs(points).max() < 1.0  # m


def test_points_from_json_and_csv(tmp_path: Path):
    expected = [[0.0, 0, 0], [1.0, 0, 0], [0.0, 1, 0], [0.0, 0, 1.5]]
    (tmp_path / "a.csv").write_text(
        "name,x,y,z\n" + "".join(f"k{i},{x},{y},{z}\n" for i, (x, y, z) in enumerate(expected))
    )
    (tmp_path / "b.csv").write_text("".join(f"{x},{y},{z}\n" for x, y, z in expected))
    (tmp_path / "c.json").write_text(json.dumps({f"k{i}": p for i, p in enumerate(expected)}))
    (tmp_path / "d.json").write_text(json.dumps({"keypoints_m": expected, "keypoint_names": ["k0", "k1", "k2", "k3"]}))
    for name in ("a.csv", "b.csv", "c.json", "d.json"):
        points, names = load_points(tmp_path / name)
        np.testing.assert_array_equal(points, expected)
        assert names[0] == ("p00" if name == "b.csv" else "k0")


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("a.csv", "1,2,3\n", "4 to"),
        ("a.csv", "1,2\n3,4\n", "x,y,z"),
        ("a.csv", "x,y,z\n1,2,q\n", "triples|numbers"),
        ("a.json", "{", "not JSON"),
        ("a.json", "[[0,0,0],[1,1,1],[2,2,2],[3,3,3]]", "one line"),
        ("a.json", "[[0,0,NaN],[1,0,1],[2,2,2],[3,3,3]]", "not finite"),
        ("a.mat", "text", "not a MATLAB file"),
        ("a.txt", "1,2,3", "found '.txt'"),
    ],
)
def test_bad_point_files_are_refused_in_one_sentence(tmp_path: Path, name: str, text: str, says: str):
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=says):
        load_points(tmp_path / name)
