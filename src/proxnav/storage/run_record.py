"""What a run's `config.json` says: the options in full, the versions that were at work, the commit, the seed."""

import platform
import subprocess
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

_LIBRARIES = (
    "proxnav", "numpy", "scipy", "numba", "opencv-python-headless", "poselib", "embreex", "onnxruntime", "openvino",
    "torch",
)  # fmt: skip
_PACKAGE = Path(__file__).parents[1]


def run_record(options: Any) -> dict[str, Any]:
    """JSON content for a run of the given options, a dataclass."""
    content = plain(options)
    seed = content.get("seed") if isinstance(content, dict) else None
    return {"options": content, "seed": seed, "versions": versions(), "commit": commit()}


def plain(value: Any) -> Any:
    """Nested dataclasses, mappings, sequences and paths as what JSON can hold."""
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return value if value is None or isinstance(value, bool | int | float | str) else str(value)


def versions() -> dict[str, str]:
    """Versions of proxnav, Python and of those libraries that are installed."""
    found = {"python": platform.python_version()}
    for name in _LIBRARIES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def commit() -> str | None:
    """The commit that the package's source stands at, with `-dirty` where it was changed; None outside its repository.

    A package that is installed inside somebody else's repository is not of that repository.
    """
    if _git("ls-files", "--error-unmatch", "__init__.py") is None:
        return None
    return _git("describe", "--always", "--dirty", "--abbrev=40", "--exclude=*")


def _git(*words: str) -> str | None:
    """What git prints; None where it fails or is not installed."""
    try:
        done = subprocess.run(["git", "-C", str(_PACKAGE), *words], capture_output=True, text=True, timeout=10.0)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout.strip() or None if done.returncode == 0 else None
