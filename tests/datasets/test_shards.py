"""A set as shards is the same set."""

import hashlib
import io
import json
import tarfile
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from tests.datasets.formats.small_sets import make_dataset

from proxnav.cli.main import main
from proxnav.datasets.set.dataset import Dataset
from proxnav.datasets.shards import is_sharded, read_index, unpack_shards, write_shards
from proxnav.detection.shard_stream import streamed
from proxnav.errors import InputError


@pytest.fixture
def shards(tmp_path: Path) -> Path:
    """Seven frames, three to a shard."""
    write_shards(Dataset(make_dataset(tmp_path / "set", 7)), tmp_path / "shards", 3)
    return tmp_path / "shards"


def contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def test_there_and_back_is_the_same_to_the_byte(shards, tmp_path, capsys) -> None:
    assert is_sharded(shards)
    assert not is_sharded(tmp_path / "set")
    assert main(["convert", str(shards), "--to", "proxnav", "--out", str(tmp_path / "back")]) == 0
    assert "7 frames" in capsys.readouterr().out
    assert contents(tmp_path / "back") == contents(tmp_path / "set")
    write_shards(Dataset(tmp_path / "back"), tmp_path / "again", 3)
    assert contents(tmp_path / "again") == contents(shards)


def test_other_tools_find_the_usual_triples(shards) -> None:
    with tarfile.open(shards / "shard-00000.tar") as tar:
        names = tar.getnames()
    assert names[:3] == ["img000003.png", "img000003.mask.png", "img000003.json"]
    assert len(names) == 9


def test_every_pass_shows_every_frame_once_and_ranks_share_it(shards) -> None:
    source = streamed(read_index(shards), seed=4)
    whole = [sample.image.tobytes() for sample in islice(source(0, 1), 14)]
    assert len(set(whole[:7])) == len(set(whole[7:])) == 7
    assert whole[:7] != whole[7:]
    for rank in (0, 1):
        assert [sample.image.tobytes() for sample in islice(source(rank, 2), 7)] == whole[rank::2]
    assert next(source(9, 1)).image.tobytes() == whole[9]
    images = {Dataset(shards.parent / "set").image(k).tobytes() for k in range(7)}
    assert set(whole[:7]) == images


def rewritten(shards: Path, change) -> None:
    """The first shard with its members changed, and the hash in the index made to fit."""
    with tarfile.open(shards / "shard-00000.tar") as tar:
        members = [(m, tar.extractfile(m).read()) for m in tar]
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w") as tar:
        for member, content in change(members):
            member.size = len(content)
            tar.addfile(member, io.BytesIO(content))
    (shards / "shard-00000.tar").write_bytes(buffer.getvalue())
    index = json.loads((shards / "index.json").read_text())
    index["shards"][0]["sha256"] = hashlib.sha256(buffer.getvalue()).hexdigest()
    (shards / "index.json").write_text(json.dumps(index))


def renamed(name: str):
    def change(members):
        members[0][0].name = name
        return members

    return change


@pytest.mark.parametrize("name", ["../evil.png", "/etc/evil.png", "a/b.png", "img.exe", "..", "x.png"])
def test_no_name_in_a_tar_leads_out_of_the_folder(shards, tmp_path, name) -> None:
    rewritten(shards, renamed(name))
    before = {path for path in tmp_path.parent.rglob("*evil*")}
    with pytest.raises(InputError, match=r"refused|out of place"):
        unpack_shards(shards, tmp_path / "out")
    assert {path for path in tmp_path.parent.rglob("*evil*")} == before


def test_a_link_in_a_tar_is_refused(shards, tmp_path) -> None:
    def linked(members):
        members[0][0].type, members[0][0].linkname = tarfile.SYMTYPE, "/etc/passwd"
        return [(members[0][0], b""), *members[1:]]

    rewritten(shards, linked)
    with pytest.raises(InputError, match="out of place"):
        unpack_shards(shards, tmp_path / "out")


def test_torn_changed_and_missing_shards_are_one_sentence(shards, tmp_path) -> None:
    whole = (shards / "shard-00001.tar").read_bytes()
    (shards / "shard-00001.tar").write_bytes(whole[:3000])
    with pytest.raises(InputError, match="not the bytes that"):
        unpack_shards(shards, tmp_path / "a")
    (shards / "shard-00001.tar").unlink()
    with pytest.raises(InputError, match="no such file"):
        unpack_shards(shards, tmp_path / "b")
    for content in (b"{}", b"[1]", b"\xff", b'{"version": 9}', b'{"version": 1, "shards": [{"file": "../x"}]}'):
        (shards / "index.json").write_bytes(content)
        with pytest.raises(InputError):
            read_index(shards)


def test_shards_hold_the_labels_of_the_set(shards) -> None:
    index, dataset = read_index(shards), Dataset(shards.parent / "set")
    found = [index.label(frame) for k in range(3) for frame in index.frames(k)]
    for label, true in zip(found, dataset.labels, strict=True):
        assert label.filename == true.filename
        np.testing.assert_array_equal(label.keypoints_px, true.keypoints_px)
        np.testing.assert_array_equal(label.T_cam_target.t_m, true.T_cam_target.t_m)
