"""Files that are either whole or absent, and JSON that is refused in one sentence."""

import csv
import errno
import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from proxnav.errors import InputError

MAX_JSON_BYTES = 2**30
"""Largest file that is read as JSON; 100,000 annotated frames take a third of it."""


def write_atomic(path: Path, content: bytes) -> None:
    """Writes `content` to `path` so that a reader sees all of it or none: temporary file beside it, then rename.

    InputError where the place cannot be written to.
    """
    try:
        with replacing(path) as part:
            part.write_bytes(content)
    except OSError as error:
        raise cannot_write(path, error) from None


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A file beside `path` to write to: it becomes `path` when the block ends well, and is removed when it does not."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
    os.close(handle)
    part = Path(name)
    try:
        yield part
        part.chmod(0o644)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


@contextmanager
def filling(folder: Path) -> Iterator[Path]:
    """A folder beside `folder` to write to, whose files move into it when the block ends well, and are gone if not.

    Files of the same names are replaced, others stay. InputError where a file is in the place.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file; name a folder to write")
    folder.parent.mkdir(parents=True, exist_ok=True)
    part = Path(tempfile.mkdtemp(dir=folder.parent, prefix=f".{folder.name}.", suffix=".part"))
    try:
        yield part
        for source in sorted(path for path in part.rglob("*") if path.is_file()):
            place = folder / source.relative_to(part)
            place.parent.mkdir(parents=True, exist_ok=True)
            source.replace(place)
    finally:
        shutil.rmtree(part, ignore_errors=True)


def cannot_write(path: Path, error: OSError) -> InputError:
    """Why a file cannot be written, and what to do: room comes back, a read-only disk does not."""
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        return InputError(f"{path}: no room left ({error.strerror}); make room, the same command resumes")
    reason = error.strerror or str(error)
    return InputError(f"{path}: cannot be written ({reason}); give another place to write to")


def check_new_file(path: Path) -> None:
    """InputError where no file can be written at `path`: to be asked before hours of work, not after."""
    if path.is_dir():
        raise InputError(f"{path} is a folder; name the file to write")
    above = next(folder for folder in path.absolute().parents if folder.exists())
    if not (above.is_dir() and os.access(above, os.W_OK)):
        raise InputError(f"{path}: cannot be written because {above} is no folder that one may write in")


def write_json(path: Path, content: Any, indent: int | None = None) -> None:
    """JSON, atomically; NaN is written as null because strict readers refuse it."""
    write_atomic(path, json_bytes(content, indent))


def json_bytes(content: Any, indent: int | None = None) -> bytes:
    """What `write_json` writes."""
    return (json.dumps(finite(content), indent=indent, allow_nan=False) + "\n").encode()


def finite(content: Any) -> Any:
    """The same content with every float that JSON cannot hold as None."""
    if isinstance(content, dict):
        return {key: finite(value) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [finite(value) for value in content]
    if (isinstance(content, float) and content != content) or content in (float("inf"), float("-inf")):
        return None
    return content


def read_json(path: Path, what: str) -> Any:
    """Content of a JSON file; InputError names the file and says what it should have been."""
    try:
        if path.stat().st_size > MAX_JSON_BYTES:
            raise InputError(f"{path}: larger than {MAX_JSON_BYTES // 2**20} MiB; expected {what}")
        return json.loads(path.read_text(encoding="utf-8"))
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; expected {what}") from None
    except IsADirectoryError:
        raise InputError(f"{path}: is a folder; expected {what}") from None
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: not readable as JSON ({error}); expected {what}") from None


@contextmanager
def refused_csv(path: Path, largest: int = 2**30) -> Iterator[None]:
    """Within it, what Python's csv reader stumbles over is an InputError; so is a file of more than `largest` bytes."""
    if path.stat().st_size > largest:
        raise InputError(f"{path}: larger than {largest // 2**20} MiB; split it")
    try:
        yield
    except csv.Error as error:
        raise InputError(f"{path}: not readable as csv ({error}); save it as comma-separated UTF-8 text") from None


def inside(folder: Path, name: str) -> Path:
    """`folder/name`; InputError when the name climbs out of the folder, or is one that no file can have."""
    try:
        path = (folder / name).resolve()
        longest, whole = max(len(os.fsencode(part)) for part in path.parts), len(os.fsencode(path))
    except (OSError, ValueError, RuntimeError):  # NUL, half a surrogate pair, links in a circle
        raise InputError(f"file name {name[:80]!r} is none that a file can have; refused") from None
    if longest > 255 or whole > 4095:
        raise InputError(f"file name {name[:80]!r}... is longer than a file's can be; refused")
    if not path.is_relative_to(folder.resolve()):
        raise InputError(f"file name {name!r} leads out of {folder}; refused")
    return path
