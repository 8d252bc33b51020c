"""Files are whole or absent, and a place that cannot be written to is one sentence."""

import pytest

from proxnav.errors import InputError
from proxnav.storage.files import check_new_file, filling, inside, write_atomic


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


def test_a_folder_is_filled_by_all_files_or_none_and_keeps_what_else_it_holds(tmp_path):
    place = tmp_path / "model"
    with filling(place) as part:
        (part / "card").write_text("first")
    with pytest.raises(InputError), filling(place) as part:  # noqa: PT012
        (part / "card").write_text("second")
        raise InputError("no")
    assert (place / "card").read_text() == "first"
    with filling(place) as part:
        (part / "target").mkdir()
        (part / "target" / "mesh").write_text("third")
    assert (place / "card").read_text() == "first"
    assert (place / "target" / "mesh").read_text() == "third"
    assert [path.name for path in tmp_path.iterdir()] == ["model"]


def test_a_folder_does_not_take_the_place_of_a_file(tmp_path):
    (tmp_path / "model").write_text("mine")
    with pytest.raises(InputError, match="is a file"), filling(tmp_path / "model"):
        pass
    assert (tmp_path / "model").read_text() == "mine"
