import subprocess
import sys

import pytest

from proxnav.cli.main import COMMANDS, main

HEAVY = (
    "numpy",
    "tyro",
    "rich",
    "fsspec",
    "s3fs",
    "lightning_fabric",
    "torch",
    "cv2",
    "scipy",
    "numba",
    "matplotlib",
    "openvino",
    "onnxruntime",
    "pandas",
    "ray",
    "rerun",
    "trimesh",
)


def _loaded(code, names):
    """Which of the modules a fresh interpreter holds after running the code."""
    code = f"import sys; {code}; print(*[name for name in {names} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()[-1].split()


def test_help_lists_every_command(capsys):
    assert main(["--help"]) == 0
    text = capsys.readouterr().out
    assert all(command in text for command in COMMANDS)
    assert len(text.splitlines()) < 24


def test_an_unknown_command_exits_2_and_names_the_known_ones(capsys):
    assert main(["fly"]) == 2
    assert "render" in capsys.readouterr().err


def test_bad_input_is_one_sentence_and_exits_1(capsys, tmp_path):
    assert main(["evaluate", str(tmp_path / "none.json"), str(tmp_path / "truth.json")]) == 1
    error = capsys.readouterr().err
    assert error.startswith("proxnav evaluate: ")
    assert "none.json" in error
    assert len(error.strip().splitlines()) == 1


@pytest.mark.parametrize(
    "command", [name for name in COMMANDS if name not in ("train", "benchmark", "setup", "target")]
)
def test_each_command_explains_itself(command, capsys):
    assert main([command, "--help"]) == 0
    assert f"proxnav {command}" in capsys.readouterr().out


def test_the_overview_imports_nothing_heavy():
    code = (
        "import sys; from proxnav.cli.main import main; main(['--help']); "
        f"print([m for m in {HEAVY} if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip().splitlines()[-1] == "[]"


@pytest.mark.parametrize("command", ["demo", "render", "estimate", "benchmark_latency"])
def test_what_runs_without_torch_never_loads_it_nor_blender(command):
    assert _loaded(f"import proxnav.estimator, proxnav.commands.{command}", ("torch", "bpy")) == []


def test_a_path_that_the_system_refuses_is_one_sentence(capsys, tmp_path):
    name = str(tmp_path / ("n" * 300))
    assert main(["target", "show", name]) == 1
    error = capsys.readouterr().err
    assert "too long" in error
    assert len(error.splitlines()) == 1


def test_a_reader_that_has_seen_enough_is_no_error():
    command = f'{sys.executable} -c \'from proxnav.cli.main import main; main(["target", "show", "space-rider"])\''
    done = subprocess.run(["bash", "-c", f"{command} | head -n 1"], capture_output=True, text=True, check=True)
    assert done.stderr == ""
