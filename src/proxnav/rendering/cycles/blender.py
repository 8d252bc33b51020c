"""Where Blender is: named by PROXNAV_BLENDER, `blender` on the PATH, or installed by `proxnav setup blender`."""

import os
import shutil
import sys
from pathlib import Path

from proxnav.errors import InputError

BPY_REQUIREMENT = "bpy==4.5.*"
READY = "proxnav-ready"
"""File that the set-up leaves in a complete environment."""
WORKER = Path(__file__).with_name("worker.py")


def data_home() -> Path:
    """The user's folder for what proxnav installs: PROXNAV_HOME, or the platform's place for application data."""
    if named := os.environ.get("PROXNAV_HOME"):
        return Path(named).expanduser()
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local") / "proxnav"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "proxnav"
    return Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share") / "proxnav"


def environment_folder() -> Path:
    """Where `proxnav setup blender` puts its virtual environment."""
    return data_home() / "blender"


def environment_python(folder: Path) -> Path:
    """The interpreter of a virtual environment."""
    return folder / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")


def find_blender() -> Path:
    """A Blender executable or a Python that has bpy; InputError says how to get one."""
    if named := os.environ.get("PROXNAV_BLENDER"):
        found = shutil.which(Path(named).expanduser())
        if found is None:
            raise InputError(
                f"PROXNAV_BLENDER names {named}, which is not an executable file; "
                "name a Blender executable or a Python with bpy, or unset it"
            )
        return Path(found)
    if found := shutil.which("blender"):
        return Path(found)
    folder = environment_folder()
    if (folder / READY).is_file():
        return environment_python(folder)
    raise InputError(
        f"no Blender found: PROXNAV_BLENDER is not set, `blender` is not on the PATH and {folder} holds no "
        "environment; run `proxnav setup blender`"
    )


def worker_command(blender: Path) -> list[str]:
    """The command line that runs the worker under a Blender executable or a Python with bpy."""
    if "python" in blender.name.lower():
        return [str(blender), "-u", str(WORKER)]
    return [str(blender), "--background", "--factory-startup", "--python-exit-code", "1", "--python", str(WORKER)]
