"""Nothing that a file says is executed, and nothing leads out of a folder; docs/security.md says what is trusted."""

import ast
import re
from pathlib import Path

import numpy as np
import pytest

import proxnav
from proxnav.detection.keypoint_rcnn.weights import read_state
from proxnav.detection.sessions import open_session
from proxnav.errors import InputError
from proxnav.storage.files import inside

PACKAGE = Path(proxnav.__file__).parent
SOURCES = sorted(PACKAGE.rglob("*.py"))
EXECUTED = {"eval", "exec", "compile", "__import__"}


def calls(path: Path) -> list[ast.Call]:
    return [node for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.Call)]


def dotted(call: ast.Call) -> str:
    return ast.unparse(call.func)


@pytest.mark.parametrize("path", SOURCES, ids=[str(path.relative_to(PACKAGE)) for path in SOURCES])
def test_no_module_loads_a_pickle_or_executes_text(path: Path) -> None:
    text = path.read_text("utf-8")
    assert not re.search(r"^\s*(import|from)\s+(pickle|cloudpickle|dill|joblib|marshal|shelve)\b", text, re.M)
    assert not re.search(r"\byaml\.(\w*load\w*|Loader|FullLoader|UnsafeLoader|CLoader)\b", text)  # SafeLoader alone
    for call in calls(path):
        options = {keyword.arg: ast.unparse(keyword.value) for keyword in call.keywords}
        name = dotted(call)
        if name == "torch.load":
            assert options.get("weights_only") == "True", f"line {call.lineno}"
        if name in ("np.load", "numpy.load"):
            assert options.get("allow_pickle") == "False", f"line {call.lineno}"
        assert name not in EXECUTED, f"line {call.lineno}"
        assert options.get("shell") != "True", f"line {call.lineno}"
        assert not name.endswith((".extractall", ".unpack_archive")), f"line {call.lineno}"


class Evil:
    """Touches a file when it is unpickled."""

    def __init__(self, mark: str) -> None:
        self.mark = mark

    def __reduce__(self):
        return Path.touch, (Path(self.mark),)


def test_a_checkpoint_that_would_run_code_is_refused_unrun(tmp_path: Path) -> None:
    import torch

    torch.save({"weight": Evil(str(tmp_path / "ran"))}, tmp_path / "evil.pt")
    with pytest.raises(InputError):
        read_state(tmp_path / "evil.pt")
    assert not (tmp_path / "ran").exists()


def test_a_mesh_array_that_would_run_code_is_refused_unrun(tmp_path: Path) -> None:
    from boxcraft import boxcraft
    from proxnav.targets.target_files import read_target, save_target

    save_target(boxcraft(), tmp_path)
    evil = np.array([Evil(str(tmp_path / "ran"))], dtype=object)
    np.savez(tmp_path / "mesh.npz", **dict.fromkeys(("vertices_m", "faces", "face_part", "corner_normals"), evil))
    with pytest.raises(InputError, match="mesh"):
        read_target(tmp_path / "target.json")
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize("name", ["../x", "/etc/passwd", "a/../../x", "..", "link/x"])
def test_no_name_leads_out_of_a_folder(name: str, tmp_path: Path) -> None:
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "link").symlink_to(tmp_path)
    with pytest.raises(InputError, match="leads out"):
        inside(tmp_path / "set", name)


@pytest.mark.parametrize("backend", ["onnxruntime", "openvino"])
def test_a_graph_cannot_read_weights_outside_its_folder(backend, tmp_path: Path) -> None:
    from onnx import TensorProto, helper

    (tmp_path / "model").mkdir()
    np.arange(4, dtype=np.float32).tofile(tmp_path / "secret.bin")
    tensor = TensorProto(name="w", data_type=TensorProto.FLOAT, data_location=TensorProto.EXTERNAL)
    tensor.dims.extend([4])
    for key, value in (("location", "../secret.bin"), ("offset", "0"), ("length", "16")):
        tensor.external_data.add(key=key, value=value)
    values = [helper.make_tensor_value_info(name, TensorProto.FLOAT, [4]) for name in ("x", "y")]
    graph = helper.make_graph([helper.make_node("Add", ["x", "w"], ["y"])], "g", values[:1], values[1:], [tensor])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    (tmp_path / "model" / "m.onnx").write_bytes(model.SerializeToString())
    with pytest.raises(InputError, match="not a graph"):
        open_session(tmp_path / "model" / "m.onnx", backend)


def test_html_in_names_stays_text() -> None:
    from proxnav.viewing import report

    page = (PACKAGE / "viewing" / "page" / "report.html").read_text("utf-8")
    assert "autoescape=True" in Path(report.__file__).read_text("utf-8")
    assert "|safe" not in page.replace(" ", "")
    assert "Content-Security-Policy" in page
