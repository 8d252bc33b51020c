"""An S3 server on the loopback, started for the tests of this folder, and a cache of their own."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.request import Request, urlopen

import pytest

from proxnav.storage.cache import cache_folder


@pytest.fixture
def bucket(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Any]:
    """(file system, URL) of a fresh bucket."""
    pytest.importorskip("s3fs", reason="needs pip install 'proxnav[storage]'")
    from moto.server import ThreadedMotoServer

    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://127.0.0.1:{server.get_host_and_port()[1]}")
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.setenv(name, "test")
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
    tables = [path for path in cache_folder().glob("*") if path.is_file()]  # of Earth: they take a minute to make
    monkeypatch.setenv("PROXNAV_CACHE", str(tmp_path / "cache"))
    (tmp_path / "cache").mkdir()
    for table in tables:
        (tmp_path / "cache" / table.name).symlink_to(table)
    import fsspec

    files = fsspec.filesystem("s3", skip_instance_cache=True)
    fsspec.filesystem("s3").clear_instance_cache()
    files.mkdir("flights")
    yield files
    fsspec.filesystem("s3").clear_instance_cache()
    with urlopen(Request(f"{os.environ['AWS_ENDPOINT_URL']}/moto-api/reset", method="POST")):
        server.stop()
