"""Object storage: what lies under a URL such as s3://bucket/set as a folder here, and back again.

Everything reads and writes folders. A URL is mirrored into the cache: what an input holds is fetched once and again
when it has changed there; what a run writes is sent now and then, and when it ends, so that a run resumes from storage
on any machine. `file://` is a folder as it is.
"""

import contextlib
import json
import re
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from proxnav.errors import InputError
from proxnav.storage.cache import cache_folder
from proxnav.storage.files import inside, replacing, write_json

_URL = re.compile(r"^(?P<scheme>file|s3|gs|gcs|abfs|az|memory):/{1,3}(?P<rest>.*)$")
MAX_FETCH_BYTES = 2**40
MAX_FETCH_FILES = 5_000_000
SEND_EVERY_S = 30.0
_STATE = ".mirror"
_NOT_SENT = (_STATE, ".part", ".lock")


def as_url(path: str | Path) -> str | None:
    """The URL that `path` is, also after a `Path` has swallowed one of its slashes; None for an ordinary path.

    >>> as_url(Path("s3://bucket/set")), as_url("out/set")
    ('s3://bucket/set', None)
    """
    match = _URL.match(str(path))
    if match is None:
        return None
    return f"{match['scheme']}://{'/' if match['scheme'] == 'file' else ''}{match['rest']}"


def filesystem(url: str) -> tuple[Any, str]:
    """(the fsspec file system, the path in it); InputError where its package is not installed."""
    try:
        import fsspec

        return fsspec.core.url_to_fs(url)
    except ImportError:
        raise InputError(f"{url}: object storage needs more packages: pip install 'proxnav[storage]'") from None


@contextmanager
def refused(url: str) -> Iterator[None]:
    """Whatever a storage library raises, as one sentence; the tools of our own pass."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:  # fsspec, botocore, aiohttp: no common base
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError(f"{url}: storage refused ({reason}); check the name, the key and the endpoint") from None


@dataclass
class Mirror:
    """One URL and its folder here; `seen` is the state of every file when both were last the same."""

    url: str
    folder: Path
    seen: dict[str, list[Any]]

    @staticmethod
    def of(url: str) -> "Mirror":
        """The mirror of a URL, where it was before."""
        if url.startswith("file://"):
            return Mirror(url, Path(url.removeprefix("file://")), {})
        scheme, _, rest = url.partition("://")
        folder = inside(cache_folder() / "mirror", f"{scheme}/{rest.strip('/')}")
        seen: dict[str, list[Any]] = {}
        with contextlib.suppress(ValueError, OSError):
            seen = dict(json.loads(_state(folder).read_text()))
        return Mirror(url, folder, seen if folder.is_dir() else {})

    @property
    def is_local(self) -> bool:
        """Whether the folder is the thing itself."""
        return self.url.startswith("file://")

    def fetch(self, needed: bool) -> Path:
        """Brings what is new there; the folder, or the file where the URL names one. InputError if nothing is there."""
        if self.is_local:
            return self.folder
        files, root = filesystem(self.url)
        with refused(self.url):
            if files.isfile(root):
                self.folder.parent.mkdir(parents=True, exist_ok=True)
                files.get_file(root, str(self.folder))
                return self.folder
            found = files.find(root, detail=True) if files.exists(root) else {}
            if needed and not found:
                raise InputError(f"{self.url}: holds nothing; check the name")
            self._check(found)
            for gone in self.seen.keys() - {path[len(root) :].lstrip("/") for path in found}:
                inside(self.folder, gone).unlink(missing_ok=True)
                del self.seen[gone]
            for path, info in sorted(found.items()):
                self._fetch_one(files, path, path[len(root) :].lstrip("/"), info)
        self._remember()
        return self.folder

    def _check(self, found: dict[str, Any]) -> None:
        size = sum(int(info.get("size") or 0) for info in found.values())
        if size > MAX_FETCH_BYTES or len(found) > MAX_FETCH_FILES:
            raise InputError(
                f"{self.url}: {len(found)} files of {size / 2**30:.0f} GiB are too many to fetch; use shards"
            )

    def _fetch_one(self, files: Any, path: str, name: str, info: dict[str, Any]) -> None:
        mark = str(info.get("ETag") or info.get("etag") or info.get("LastModified") or info.get("created") or "")
        place = inside(self.folder, name)
        if not name or (place.exists() and self.seen.get(name, [None])[0] == mark):
            return
        with replacing(place) as part:
            files.get_file(path, str(part))
        self.seen[name] = [mark, *_stamp(place)]

    def send(self) -> int:
        """Sends what is new or changed here and removes there what was removed here; how many files."""
        if self.is_local:
            return 0
        files, root = filesystem(self.url)
        count = 0
        with refused(self.url):
            if self.folder.is_file():
                files.put_file(str(self.folder), root)
                return 1
            here = dict(self._here())
            for name, place in here.items():
                stamp = _stamp(place)
                if self.seen.get(name, [None, None, None])[1:] == stamp:
                    continue
                files.put_file(str(place), f"{root.rstrip('/')}/{name}")
                self.seen[name] = ["", *stamp]
                count += 1
            for name in [name for name in self.seen if name not in here]:
                with contextlib.suppress(FileNotFoundError):
                    files.rm_file(f"{root.rstrip('/')}/{name}")
                del self.seen[name]
        self._remember()
        return count

    def _here(self) -> Iterator[tuple[str, Path]]:
        for path in sorted(self.folder.rglob("*")):
            if path.is_file() and not path.name.endswith(_NOT_SENT):
                yield path.relative_to(self.folder).as_posix(), path

    def _remember(self) -> None:
        if self.folder.is_dir():
            write_json(_state(self.folder), self.seen)


def _state(folder: Path) -> Path:
    """Beside the folder: what is in it is the run's alone."""
    return folder.with_name(f".{folder.name}{_STATE}")


def _stamp(path: Path) -> list[int]:
    status = path.stat()
    return [status.st_size, status.st_mtime_ns]


@contextmanager
def sent_back(mirror: Mirror) -> Iterator[Path]:
    """The folder of an output: fetched first, so that a run resumes; sent now and then and however the block ends."""
    place = mirror.fetch(needed=False)
    over = threading.Event()

    def now_and_then() -> None:
        while not over.wait(SEND_EVERY_S):
            with contextlib.suppress(InputError, OSError):  # the network may come back; the last sending says if not
                mirror.send()

    sender = threading.Thread(target=now_and_then, daemon=True, name="send")
    if not mirror.is_local:
        sender.start()
    try:
        yield place
    finally:
        over.set()
        if sender.is_alive():
            sender.join()
        mirror.send()
