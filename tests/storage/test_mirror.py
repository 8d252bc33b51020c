"""What lies in object storage reads and writes like a folder."""

from pathlib import Path

import pytest

from proxnav.errors import InputError
from proxnav.storage.mirror import Mirror, as_url, sent_back

pytestmark = pytest.mark.filterwarnings("ignore")  # botocore's own


@pytest.mark.parametrize(
    ("path", "url"),
    [
        ("s3://b/set", "s3://b/set"), (Path("s3://b/set"), "s3://b/set"), ("file:///a/b", "file:///a/b"),
        (Path("file:///a/b"), "file:///a/b"), ("out/set", None), ("/s3:/b", None), ("ray://h:1", None), ("C:/x", None),
    ],
)  # fmt: skip
def test_a_url_is_known_also_as_a_path(path, url) -> None:
    assert as_url(path) == url


def test_what_is_written_comes_back_and_only_changes_travel(bucket, tmp_path) -> None:
    mirror = Mirror.of("s3://flights/run")
    with sent_back(mirror) as place:
        place.mkdir(parents=True)
        (place / "deep").mkdir()
        (place / "deep" / "a.txt").write_text("one")
        (place / "b.txt").write_text("two")
        (place / ".c.txt.x.part").write_text("half")
    assert sorted(bucket.find("flights/run")) == ["flights/run/b.txt", "flights/run/deep/a.txt"]
    assert Mirror.of("s3://flights/run").send() == 0
    (place / "b.txt").write_text("changed")
    (place / "deep" / "a.txt").unlink()
    assert Mirror.of("s3://flights/run").send() == 1
    bucket.invalidate_cache()
    assert bucket.find("flights/run") == ["flights/run/b.txt"]
    assert bucket.cat("flights/run/b.txt") == b"changed"


def test_a_change_there_arrives_here_and_a_removal_too(bucket) -> None:
    bucket.pipe({"flights/set/x": b"1", "flights/set/y": b"2"})
    place = Mirror.of("s3://flights/set").fetch(needed=True)
    assert (place / "x").read_bytes() == b"1"
    bucket.pipe("flights/set/x", b"longer")
    bucket.rm("flights/set/y")
    Mirror.of("s3://flights/set").fetch(needed=True)
    assert (place / "x").read_bytes() == b"longer"
    assert not (place / "y").exists()


def test_a_run_that_breaks_is_sent_all_the_same(bucket) -> None:
    def breaks() -> None:
        with sent_back(Mirror.of("s3://flights/broken")) as place:
            place.mkdir(parents=True)
            (place / "half.txt").write_text("kept")
            raise RuntimeError("power cut")

    with pytest.raises(RuntimeError, match="power cut"):
        breaks()
    assert bucket.cat("flights/broken/half.txt") == b"kept"


def test_names_that_climb_and_places_that_are_not_are_refused(bucket) -> None:
    bucket.pipe("flights/evil/../../../climbed", b"x")
    with pytest.raises(InputError, match=r"leads out|refused"):
        Mirror.of("s3://flights/evil").fetch(needed=True)
    with pytest.raises(InputError, match="leads out"):
        Mirror.of("s3://../../etc")
    with pytest.raises(InputError, match="holds nothing"):
        Mirror.of("s3://flights/none").fetch(needed=True)
    with pytest.raises(InputError, match="refused"):
        _send()


def _send() -> None:
    with sent_back(Mirror.of("s3://no-such-bucket/set")) as place:
        place.mkdir(parents=True)
        (place / "a").write_text("x")
