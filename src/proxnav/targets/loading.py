"""A target by name or by file."""

from functools import lru_cache
from pathlib import Path

from proxnav.errors import InputError, did_you_mean
from proxnav.targets.cad.from_mesh import from_mesh
from proxnav.targets.space_rider import space_rider
from proxnav.targets.tango import tango
from proxnav.targets.target import Target
from proxnav.targets.target_files import read_target

GENERATED = {"space-rider": space_rider, "tango": tango}


def load_target(name_or_path: str) -> Target:
    """`space-rider`, `tango`, a target.json (or its folder), or a mesh file whose unit is declared or metres.

    The same file gives the same object, so that what is built from it (ray casters, textures) is built once.
    """
    if name_or_path in GENERATED:
        return GENERATED[name_or_path]()
    path = Path(name_or_path)
    path = path / "target.json" if path.is_dir() else path
    if not path.is_file():
        near = did_you_mean(str(name_or_path), GENERATED)
        names = ", ".join(GENERATED)
        raise InputError(f"no target '{name_or_path}'; expected {names}, a target.json or a mesh file{near}")
    return _from_file(str(path.resolve()), path.stat().st_mtime_ns)


@lru_cache(maxsize=4)
def _from_file(path: str, changed_ns: int) -> Target:
    del changed_ns  # part of the cache's key: an edited file is read again
    return read_target(path) if path.lower().endswith(".json") else from_mesh(path)
