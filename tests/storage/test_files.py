"""Files are whole or absent, and a place that cannot be written to is one sentence."""

import pytest

from proxnav.errors import InputError
from proxnav.storage.files import check_new_file, inside, write_atomic


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


@pytest.mark.parametrize(
    ("name", "said"),
    [("../up", "leads out"), ("/etc/passwd", "leads out"), ("x" * 256, "longer than"), ("x/" * 3000, "longer than"),
     ("a\0b", "none that a file can have"), ("\ud800.png", "none that a file can have"), ("loop/x", "none that")],
)  # fmt: skip
def test_a_name_that_leads_out_or_that_no_file_can_have_is_refused(name, said, tmp_path):
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    with pytest.raises(InputError, match=said):
        inside(tmp_path, name)
    assert inside(tmp_path, "deep/er/new.png") == (tmp_path / "deep/er/new.png").resolve()
