"""Compiled code on disk knows the files that it was made from."""

from pathlib import Path

import pytest

from proxnav.geometry.compiled import lens
from proxnav.geometry.compiled.sources import digest

HEADER = "from proxnav.geometry.compiled.kernel import kernel\n"


@pytest.fixture
def package(tmp_path: Path) -> Path:
    (tmp_path / "room").mkdir()
    (tmp_path / "outer.py").write_text(HEADER + "from proxnav.room.inner import f\nfrom proxnav.room import sizes\n")
    (tmp_path / "room" / "inner.py").write_text(HEADER + "from proxnav.room.deep import (\n    g,\n)\n")
    for name in ("deep", "sizes"):
        (tmp_path / "room" / f"{name}.py").write_text("from proxnav.plain import ONE\n")
    (tmp_path / "plain.py").write_text("ONE = 1\n")
    return tmp_path


@pytest.mark.parametrize("changed", ["outer.py", "room/inner.py", "room/deep.py", "room/sizes.py"])
def test_a_change_in_what_a_kernel_calls_or_reads_changes_its_digest(package: Path, changed: str) -> None:
    before = digest(package / "outer.py", package)
    (package / changed).write_text((package / changed).read_text() + "# changed\n")
    digest.cache_clear()
    assert digest(package / "outer.py", package) != before


def test_a_change_behind_files_without_compiled_code_leaves_the_digest(package: Path) -> None:
    before = digest(package / "outer.py", package)
    (package / "plain.py").write_text("ONE = 2\n")
    digest.cache_clear()
    assert digest(package / "outer.py", package) == before


def test_numba_keeps_the_digest_beside_the_code() -> None:
    path = Path(lens.__file__)
    stamp = lens.distort._cache._cache_file._source_stamp  # pyright: ignore
    assert stamp[1] == digest(path, path.parents[2])
