"""Makes the virtual environment that Blender's Python module lives in, apart from ours (see blender.py)."""

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from proxnav.errors import InputError
from proxnav.rendering.cycles.blender import BPY_REQUIREMENT, READY, environment_folder, environment_python

PYTHON = (3, 11)
"""The one version of CPython that bpy 4.5 has wheels for."""


def make_environment(say: Callable[[str], None]) -> Path:
    """The interpreter of a verified environment with bpy; makes it unless it is there. Safe to run twice at once."""
    folder = environment_folder()
    if (folder / READY).is_file():
        say(f"Blender is ready in {folder}")
        return environment_python(folder)
    base = _base_python()
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="blender-", dir=folder.parent, ignore_cleanup_errors=True) as scratch:
        made = Path(scratch) / "environment"
        say(f"Making a virtual environment with {base} ...")
        _run([base, "-m", "venv", str(made)], "make a virtual environment")
        say(f"Installing {BPY_REQUIREMENT} (a download of about 400 MB) ...")
        pip = [str(environment_python(made)), "-m", "pip", "--disable-pip-version-check", "install", "--no-compile"]
        _run([*pip, BPY_REQUIREMENT], f"install {BPY_REQUIREMENT}", show=True)
        version = verify(environment_python(made))
        (made / READY).write_text(f"{version}\n", encoding="utf-8")
        _move(made, folder)
    say(f"Blender {version} is ready in {folder}")
    return environment_python(folder)


def verify(python: Path) -> str:
    """The version of Blender that `python` imports; InputError when it cannot."""
    code = "import bpy; print('version', bpy.app.version_string)"
    output = _run([str(python), "-c", code], f"import bpy under {python}")
    return output.rsplit("version ", 1)[-1].strip()


def _base_python() -> str:
    if sys.version_info[:2] == PYTHON:
        return sys.executable
    name = f"python{PYTHON[0]}.{PYTHON[1]}"
    found = shutil.which(name)
    probe = f"import sys; raise SystemExit(sys.version_info[:2] != {PYTHON})"
    if found is None or subprocess.run([found, "-c", probe], capture_output=True).returncode != 0:
        here = f"{sys.version_info[0]}.{sys.version_info[1]}"
        raise InputError(
            f"bpy 4.5 needs CPython 3.11, this is {here} and no working {name} is on the PATH; install Python 3.11, "
            "or set PROXNAV_BLENDER to a Blender 4.5 executable"
        )
    return found


def _run(command: list[str], job: str, show: bool = False) -> str:
    """Runs a command, showing or returning what it prints; InputError with its last words when it fails."""
    done = subprocess.run(command, stdout=None if show else subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        words = " ".join((done.stderr or done.stdout or "").split())[-600:]
        raise InputError(f"could not {job} (exit status {done.returncode}): {words}")
    return done.stdout or ""


def _move(made: Path, folder: Path) -> None:
    """Puts the environment in its place, unless another set-up was faster."""
    if folder.exists() and not (folder / READY).is_file():
        shutil.rmtree(folder)  # left by an interrupted version of ourselves
    try:
        made.rename(folder)
    except OSError:
        if not (folder / READY).is_file():
            raise
