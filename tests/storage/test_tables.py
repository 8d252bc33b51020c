"""Csv tables written and read back; what is none is refused."""

from pathlib import Path

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.storage.tables import read_rows, read_table, write_columns


def test_numbers_come_back_equal_and_texts_beside_them(tmp_path: Path, rng: np.random.Generator) -> None:
    values = rng.normal(size=5) * 10.0 ** rng.integers(-12, 12, 5)
    path = write_columns(tmp_path / "a.csv", {"status": list("abcde"), "x_m": values.tolist(), "n": [1.0] * 5})
    table = read_table(path)
    assert table.status == tuple("abcde")
    np.testing.assert_array_equal(table.block("x_m", "n"), np.c_[values, np.ones(5)])


def test_a_cell_that_is_no_number_is_refused_where_numbers_are_needed(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("x,y\n1,2\n3,none\n")
    table = read_table(tmp_path / "a.csv")
    np.testing.assert_array_equal(table.column("x"), [1, 3])
    assert np.isnan(table.columns["y"][1])
    with pytest.raises(InputError, match="column y is missing or holds"):
        table.column("y")
    with pytest.raises(InputError, match="column z is missing"):
        table.column("z")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "no rows"),
        (b"x,y\n", "cut short"),
        (b"x,y\n1\n", "cut short"),
        (b"\xff\xfe", "UTF-8"),
        (b"a" * 5000, "cell"),
    ],
)
def test_a_file_that_is_no_table_is_refused_in_one_sentence(tmp_path: Path, content: bytes, says: str) -> None:
    (tmp_path / "a.csv").write_bytes(content)
    with pytest.raises(InputError, match=says) as caught:
        read_table(tmp_path / "a.csv")
    assert "\n" not in str(caught.value)


def test_a_missing_table_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nowhere\.csv: no such csv file"):
        read_rows(tmp_path / "nowhere.csv")
