"""A folder that fills: each image file once, when it is whole, however slowly it is written."""

import re
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from threading import Event
from typing import Literal

from proxnav.datasets.image_folders import SUFFIXES
from proxnav.errors import InputError
from proxnav.geometry.types import Image
from proxnav.images.codecs import decode_image, read_image_file
from proxnav.live.stream.arrivals import Arrival, Back, Gone, Heard

Times = Literal["file", "name"]
"""file: when it was written, seconds since 1970; name: the last number in its name, seconds since any epoch."""
_POLL_S = 0.05
_SETTLE_S = 1.0
"""A file that does not end as its kind must, or that is empty, is given up when it was the same for so long."""
_ENDS = {".png": b"IEND\xaeB`\x82", ".jpg": b"\xff\xd9", ".jpeg": b"\xff\xd9"}
_NUMBER = re.compile(r"\d+(?:\.\d+)?")


@dataclass(slots=True)
class _Seen:
    size: int
    changed_ns: int
    since: float
    """Clock when the file was first seen in this state."""


@dataclass(slots=True)
class FolderSource:
    """Image files of a folder in the order of their times; those that are there already are the first."""

    folder: Path
    times: Times = "file"
    idle_s: float = 0.0
    """Ends when nothing came for so long; 0 never ends."""
    _growing: dict[str, _Seen] = field(default_factory=dict)
    _done: set[str] = field(default_factory=set)

    def heard(self, stop: Event) -> Iterator[Heard | None]:
        """Each file once it is whole; None after each look that found none."""
        is_there, last = True, time.monotonic()
        while not stop.is_set():
            looked = time.monotonic()
            try:
                found = self._whole()
            except OSError as error:
                if is_there:
                    yield Gone(f"{self.folder}: {error.strerror}")
                is_there, found = False, []
            else:
                if not is_there:
                    yield Back()
                is_there = True
            yield from found
            last = time.monotonic() if found or self._growing else last
            if self.idle_s > 0.0 and time.monotonic() - last > self.idle_s:
                return
            yield None
            stop.wait(max(_POLL_S, 3.0 * (time.monotonic() - looked)))  # a folder of 100 000 files takes long to list

    def _whole(self) -> list[Arrival]:
        """Files that became whole since the last look, in the order of their times."""
        names: set[str] = set()
        found: list[Arrival] = []
        for path in self.folder.iterdir():
            if path.suffix.lower() not in SUFFIXES:
                continue
            names.add(path.name)
            if path.name not in self._done and self._is_settled(path):
                self._done.add(path.name)
                self._growing.pop(path.name, None)
                found.append(Arrival(path.name, self._time(path), time.monotonic(), partial(_decoded, path)))
        self._done &= names  # memory does not grow where somebody clears the folder
        return sorted(found, key=lambda one: (one.t, one.name))

    def _is_settled(self, path: Path) -> bool:
        """Whether a file is the same as at the last look and ends as its kind must, or has not changed for long."""
        try:
            stat = path.stat()
        except OSError:
            return False  # gone between the two looks
        now, seen = time.monotonic(), self._growing.get(path.name)
        if seen is None or (seen.size, seen.changed_ns) != (stat.st_size, stat.st_mtime_ns):
            self._growing[path.name] = _Seen(stat.st_size, stat.st_mtime_ns, now)
            return _is_whole(path, stat.st_size) is True
        return _is_whole(path, stat.st_size) is not False or now - seen.since > _SETTLE_S

    def _time(self, path: Path) -> float:
        """When an image was taken; that of a name without a number is before all others."""
        if self.times == "file":
            try:
                return path.stat().st_mtime
            except OSError:
                return -float("inf")
        numbers = _NUMBER.findall(path.stem)
        return float(numbers[-1]) if numbers else -float("inf")


def _is_whole(path: Path, size: int) -> bool | None:
    """Whether the file ends as its kind must; None where its kind has no certain end."""
    if size == 0:
        return False
    end = _ENDS.get(path.suffix.lower())
    if end is None:
        return None
    try:
        with path.open("rb") as file:
            file.seek(max(0, size - 64))
            return end in file.read()
    except OSError:
        return False


def _decoded(path: Path) -> Image:
    content = read_image_file(path)
    if not content:
        raise InputError(f"{path}: empty")
    end = _ENDS.get(path.suffix.lower())
    if end is not None and end not in content[-64:]:
        raise InputError(f"{path}: truncated")
    return decode_image(content, str(path))
