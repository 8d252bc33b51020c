"""Files are whole or absent, and a place that cannot be written to is one sentence."""

import pytest

from proxnav.datasets.files import check_new_file, write_atomic
from proxnav.errors import InputError


@pytest.fixture
def blocked(tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("mine")
    return tmp_path


@pytest.mark.parametrize("place", ["folder", "file/below"])
def test_a_place_that_cannot_be_written_is_one_sentence_before_and_after(blocked, place):
    with pytest.raises(InputError, match=place):
        check_new_file(blocked / place)
    with pytest.raises(InputError, match="cannot be written"):
        write_atomic(blocked / place, b"new")
    assert (blocked / "file").read_text() == "mine"
    assert not list(blocked.rglob("*.part"))


@pytest.mark.parametrize("place", ["new", "deep/er/new", "file"])
def test_a_new_file_and_one_to_replace_are_fine(blocked, place):
    check_new_file(blocked / place)
    write_atomic(blocked / place, b"new")
    assert (blocked / place).read_bytes() == b"new"
