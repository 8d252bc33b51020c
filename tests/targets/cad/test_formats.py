"""STEP, COLLADA and USD: shape, unit and axes that the file declares; formats that are not read, and why."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from new_craft import cubesat_step
from proxnav.errors import InputError
from proxnav.targets.cad import collada, converted
from proxnav.targets.cad.from_mesh import from_mesh
from step_files import cuboid, write_step

USD = """#usda 1.0
(
    metersPerUnit = 0.01
    upAxis = "Z"
)
def Xform "craft"
{
    double3 xformOp:translate = (100, 0, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def Mesh "plate"
    {
        int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]
        int[] faceVertexIndices = [0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3]
        point3f[] points = [(0, 0, 0), (0, 0, 30), (0, 20, 0), (0, 20, 30),
            (10, 0, 0), (10, 0, 30), (10, 20, 0), (10, 20, 30)]
        color3f[] primvars:displayColor = [(0.1, 0.2, 0.8)]
    }
    def Cylinder "boom"
    {
        double radius = 5
        double height = 80
        token axis = "X"
        color3f[] primvars:displayColor = [(0.9, 0.9, 0.9)]
    }
    def Cube "hidden"
    {
        token visibility = "invisible"
    }
}
"""


def corners(target) -> np.ndarray:
    return np.array([target.vertices_m.min(axis=0), target.vertices_m.max(axis=0)])


@pytest.mark.parametrize(("prefix", "unit"), [(".MILLI.", 1e-3), (".CENTI.", 1e-2), ("$", 1.0)])
def test_a_step_file_has_the_unit_that_it_declares(tmp_path: Path, prefix: str, unit: float) -> None:
    low, high = np.array([1.0, 2, 3]) * 0.1 / unit, np.array([3.0, 5, 8]) * 0.1 / unit
    target = from_mesh(write_step(tmp_path / "a.stp", [cuboid("bus", low, high, (0.1, 0.2, 0.8))], prefix))
    np.testing.assert_allclose(corners(target), [[0.1, 0.2, 0.3], [0.3, 0.5, 0.8]], atol=1e-6)
    assert f"1 unit = {unit:g} m" in target.source
    red, green, blue = target.materials[0].albedo
    assert blue > 5 * red > 0 < green


def test_a_cubesat_box_from_step_has_eight_keypoints_and_says_so(tmp_path: Path) -> None:
    said: list[str] = []
    target = from_mesh(cubesat_step(tmp_path / "6u.step"), say=said.append)
    np.testing.assert_allclose(corners(target), [[0, 0, 0], [0.2263, 0.1, 0.366]], atol=1e-6)
    np.testing.assert_allclose(np.sort(np.unique(target.keypoints_m[:, 2].round(6))), [0.0, 0.366])
    assert len(target.keypoint_names) == 8
    assert sum("8 keypoints: the mesh has no more" in sentence for sentence in said) == 1


def test_a_collada_file_has_its_unit_axis_and_node_transforms(tmp_path: Path) -> None:
    scene = trimesh.Scene(trimesh.creation.box((10, 20, 30)))
    text = scene.to_geometry().export(file_type="dae").decode()
    text = text.replace("<asset>", '<asset><unit name="inch" meter="0.0254"/>', 1) if "<unit" not in text else text
    text = text.replace("<up_axis>Y_UP", "<up_axis>Z_UP")
    text = text.replace("<instance_geometry", "<translate>100 0 0</translate><instance_geometry", 1)
    (tmp_path / "a.dae").write_text(text)
    unit, _ = collada.collada_head(tmp_path / "a.dae")
    target = from_mesh(tmp_path / "a.dae")
    assert unit is not None
    np.testing.assert_allclose(corners(target), np.array([[95, -10, -15], [105, 10, 15]]) * unit, atol=1e-6)


def test_a_usd_stage_has_its_unit_transforms_and_primitives(tmp_path: Path) -> None:
    (tmp_path / "a.usda").write_text(USD)
    target = from_mesh(tmp_path / "a.usda")
    assert target.part_names == ("plate", "boom")
    plate = target.vertices_m[target.faces[target.face_part == 0].ravel()]
    np.testing.assert_allclose([plate.min(axis=0), plate.max(axis=0)], [[1, 0, 0], [1.1, 0.2, 0.3]], atol=1e-6)
    boom = target.vertices_m[target.faces[target.face_part == 1].ravel()]
    np.testing.assert_allclose(np.ptp(boom, axis=0), [0.8, 0.1, 0.1], atol=1e-3)
    np.testing.assert_allclose(target.materials[0].albedo, [0.1, 0.2, 0.8], atol=0.01)
    whole = trimesh.Trimesh(target.vertices_m, target.faces[target.face_part == 0])
    assert whole.volume == pytest.approx(0.1 * 0.2 * 0.3, rel=1e-4)  # outward


def test_a_unit_that_contradicts_the_file_is_refused(tmp_path: Path) -> None:
    path = cubesat_step(tmp_path / "6u.step")
    with pytest.raises(InputError, match=r"declares a unit of 0\.001 m, --unit says 1 m"):
        from_mesh(path, unit_m=1.0)
    assert np.ptp(from_mesh(path, length_m=0.4).vertices_m, axis=0).max() == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.step", b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=JUNK(", "no single unit of length"),
        ("a.step", b"ISO-10303-21;\nHEADER;\n#1=SI_UNIT(.MILLI.,.METRE.);", "cannot be read"),
        ("a.step", b"solid", "no ISO-10303-21 header"),
        ("a.dae", b"<xml/>", "no COLLADA"),
        ("a.dae", b"<!DOCTYPE a [<!ENTITY b 'c'>]><COLLADA/>", "XML entities"),
        ("a.dae", b"<COLLADA><init_from>../../etc/passwd</init_from></COLLADA>", "outside its folder"),
        ("a.dae", b"<COLLADA><asset><unit meter='x'/></asset></COLLADA>", "expected a positive length"),
        ("a.dae", b"<COLLADA></COLLADA>", "cannot be read"),
        ("a.usda", b"#usda 1.0\ndef Mesh", "cannot be read"),
        ("a.usda", b"#usda 1.0\n", "no visible mesh"),
        ("a.usda", b'#usda 1.0\n(subLayers=[@/etc/hosts.usda@])\ndef Cube "a"{}\n', "outside its folder"),
        ("a.usda", b'#usda 1.0\n(subLayers=[@beside.usda@])\ndef Cube "a"{}\n', "beside.usda, which is not there"),
        ("a.usdc", b"nothing", "no USD file"),
        ("a.blend", b"BLENDER", r"glTF Binary \(\.glb\)"),
        ("a.urdf", b"<robot/>", "mesh of each link"),
        ("a.fbx", b"Kaydara", "export it as GLB"),
    ],
)
def test_what_cannot_be_read_is_one_sentence(tmp_path: Path, name: str, content: bytes, says: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=says) as refusal:
        from_mesh(tmp_path / name)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("name", "content", "library"),
    [
        ("a.step", b"ISO-10303-21;HEADER;", "cascadio"),
        ("a.dae", b"<COLLADA/>", "pycollada"),
        ("a.usda", b"#usda 1.0\n", "usd-core"),
    ],
)
def test_a_reader_that_is_not_installed_is_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, content: bytes, library: str
) -> None:
    (tmp_path / name).write_bytes(content)
    for module in (collada, converted):
        monkeypatch.setattr(module, "find_spec", lambda _: None)
    with pytest.raises(InputError, match=rf'{library}.*pip install "proxnav\[cad\]"'):
        from_mesh(tmp_path / name)
