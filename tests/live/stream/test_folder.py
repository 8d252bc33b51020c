"""A folder that fills: files in pieces, empty and truncated ones, a folder that goes and comes back."""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from threading import Event

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.images.codecs import encode_png
from proxnav.live.stream import folder as folder_module
from proxnav.live.stream.arrivals import Arrival, Back, Gone, Heard
from proxnav.live.stream.folder import FolderSource

PNG = encode_png(np.random.default_rng(0).integers(0, 255, (24, 32), dtype=np.uint8))


@pytest.fixture(autouse=True)
def _quick(monkeypatch):
    monkeypatch.setattr(folder_module, "_POLL_S", 0.001)
    monkeypatch.setattr(folder_module, "_SETTLE_S", 0.01)


def until(heard: Iterator[Heard | None]) -> Heard:
    """The next that is not silence."""
    return next(one for one in heard if one is not None)


def arrival(heard: Iterator[Heard | None]) -> Arrival:
    one = until(heard)
    assert isinstance(one, Arrival)
    return one


def test_each_file_comes_once_in_the_order_of_the_numbers_in_its_name(tmp_path):
    for name in ("f_10.png", "f_9.5.png", "f_2.png", "notes.txt"):
        (tmp_path / name).write_bytes(PNG)
    heard = FolderSource(tmp_path, "name", idle_s=0.05).heard(Event())
    found = [one for one in heard if one is not None]
    assert [(one.name, one.t) for one in found] == [("f_2.png", 2.0), ("f_9.5.png", 9.5), ("f_10.png", 10.0)]
    assert found[0].load().shape == (24, 32)


def test_times_of_files_are_when_they_were_written(tmp_path):
    for name, t in (("b.png", 100.0), ("a.png", 200.0)):
        (tmp_path / name).write_bytes(PNG)
        os.utime(tmp_path / name, (t, t))
    heard = FolderSource(tmp_path, "file", idle_s=0.05).heard(Event())
    assert [(one.name, one.t) for one in heard if one] == [("b.png", 100.0), ("a.png", 200.0)]


def test_a_file_that_is_still_written_is_waited_for(tmp_path, monkeypatch):
    monkeypatch.setattr(folder_module, "_SETTLE_S", 1e9)
    (tmp_path / "1.png").write_bytes(PNG[:100])
    heard = FolderSource(tmp_path).heard(Event())
    assert [next(heard) for _ in range(5)] == [None] * 5
    (tmp_path / "1.png").write_bytes(PNG)
    assert arrival(heard).load().shape == (24, 32)


@pytest.mark.parametrize(("content", "says"), [(b"", "empty"), (PNG[:-20], "truncated"), (b"x" * 50, "truncated")])
def test_a_file_that_stays_empty_or_truncated_comes_and_says_so(tmp_path, content, says):
    (tmp_path / "1.png").write_bytes(content)
    with pytest.raises(InputError, match=says):
        arrival(FolderSource(tmp_path).heard(Event())).load()


def test_a_folder_that_goes_is_waited_for_and_goes_on(tmp_path):
    place: Path = tmp_path / "in"
    place.mkdir()
    (place / "1.png").write_bytes(PNG)
    heard = FolderSource(place).heard(Event())
    assert arrival(heard).name == "1.png"
    shutil.rmtree(place)
    assert isinstance(until(heard), Gone)
    assert [next(heard) for _ in range(3)] == [None] * 3
    place.mkdir()
    (place / "2.png").write_bytes(PNG)
    assert isinstance(until(heard), Back)
    assert arrival(heard).name == "2.png"


def test_a_stop_ends_it(tmp_path):
    stop = Event()
    heard = FolderSource(tmp_path).heard(stop)
    next(heard)
    stop.set()
    assert list(heard) == []
