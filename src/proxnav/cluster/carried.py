"""A folder as a value: what a worker on another machine needs and does not have, such as a model of one's own."""

import tempfile
from dataclasses import dataclass
from pathlib import Path

from proxnav.errors import InputError
from proxnav.storage.files import inside, write_atomic

MAX_BYTES = 2**30


@dataclass(frozen=True)
class Carried:
    """The files of a folder by name."""

    files: dict[str, bytes]

    @staticmethod
    def of(folder: Path) -> "Carried":
        """The files directly in `folder`; InputError for a folder that is too much to send."""
        paths = sorted(path for path in folder.iterdir() if path.is_file())
        size = sum(path.stat().st_size for path in paths)
        if size > MAX_BYTES:
            raise InputError(f"{folder}: {size / 2**20:.0f} MiB; at most {MAX_BYTES // 2**20} are sent to workers")
        return Carried({path.name: path.read_bytes() for path in paths})

    def unpacked(self) -> tempfile.TemporaryDirectory[str]:
        """The folder again, until the returned object is cleaned up."""
        place = tempfile.TemporaryDirectory(prefix="proxnav-")
        for name, content in self.files.items():
            write_atomic(inside(Path(place.name), name), content)
        return place
