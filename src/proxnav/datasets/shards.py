"""Large data sets as WebDataset shards: tar files that are read from front to back, on disk or in object storage.

index.json        version, camera, target, and the shards with their counts and hashes
shard-00000.tar   for each frame KEY: KEY.png (image), KEY.mask.png, KEY.json (its COCO annotation and scene line)

The tars are plain USTAR with every date and owner zero: the same set gives the same bytes. Converted back, the set is
the same to the byte.
"""

import hashlib
import io
import json
import tarfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from proxnav.datasets.set import coco
from proxnav.datasets.set.dataset import Dataset
from proxnav.errors import InputError
from proxnav.records import FrameLabel
from proxnav.storage.files import MAX_JSON_BYTES, inside, json_bytes, read_json, write_atomic, write_json
from proxnav.storage.mirror import as_url, filesystem, refused

VERSION = 1
MAX_SHARD_BYTES = 2**31
"""Largest shard that is read: one is held in memory while its frames are shuffled."""
_PARTS = ("png", "mask.png", "json")
_DOCUMENTS = ("camera.json", "target.json", "config.json")


@dataclass(frozen=True)
class StoredFrame:
    """One frame of a shard, still encoded."""

    key: str
    image: bytes
    mask: bytes
    record: dict[str, Any]
    """`annotation`: of COCO; `scene`: its line of scenes.jsonl, where there is one."""


@dataclass(frozen=True)
class ShardIndex:
    """What all frames share, and where they are."""

    place: str
    """Folder or URL."""
    shards: tuple[tuple[str, int, str], ...]
    """(file name, frames, SHA-256)."""
    keypoint_names: tuple[str, ...]
    documents: dict[str, Any]
    """camera.json, target.json and config.json of the set."""
    info: dict[str, Any]
    """COCO's info, images' ids by key and categories."""

    def __len__(self) -> int:
        return sum(count for _, count, _ in self.shards)

    def frames(self, shard: int) -> Iterator[StoredFrame]:
        """The frames of one shard in order; InputError where it is not what the index says."""
        name, count, digest = self.shards[shard]
        content = read_at(self.place, name, MAX_SHARD_BYTES)
        if hashlib.sha256(content).hexdigest() != digest:
            raise InputError(f"{self.place}/{name}: not the bytes that index.json names; copy or convert it again")
        found = list(_frames(content, f"{self.place}/{name}"))
        if len(found) != count:
            raise InputError(f"{self.place}/{name}: {len(found)} frames, index.json says {count}; convert it again")
        yield from found

    def label(self, frame: StoredFrame) -> FrameLabel:
        """The truth of a frame."""
        entry = frame.record["annotation"]
        category = {"keypoints": list(self.keypoint_names)}
        images = [{"id": entry.get("image_id"), "file_name": f"{frame.key}.png"}]
        document = {"info": self.info, "images": images, "annotations": [entry], "categories": [category]}
        return coco.parse(document, f"{self.place}, {frame.key}")[1][0]


def read_at(place: str, name: str, limit: int) -> bytes:
    """A file of a folder or URL, whole; InputError where it is absent or larger than `limit`."""
    url = as_url(place)
    if url is None or url.startswith("file://"):
        path = inside(Path(place if url is None else url.removeprefix("file://")), name)
        if not path.is_file():
            raise InputError(f"{path}: no such file")
        if path.stat().st_size > limit:
            raise InputError(f"{path}: larger than {limit // 2**20} MiB")
        return path.read_bytes()
    files, root = filesystem(url)
    with refused(f"{url}/{name}"):
        path = f"{root.rstrip('/')}/{checked(name)}"
        if files.size(path) > limit:
            raise InputError(f"{url}/{name}: larger than {limit // 2**20} MiB")
        return files.cat_file(path)


def is_sharded(place: str | Path) -> bool:
    """Whether a folder or URL holds shards."""
    url = as_url(place)
    if url is None or url.startswith("file://"):
        folder = Path(place if url is None else url.removeprefix("file://"))
        return (folder / "index.json").is_file() and not (folder / "annotations.json").exists()
    files, root = filesystem(url)
    with refused(url):
        return bool(files.exists(f"{root.rstrip('/')}/index.json"))


def read_index(place: str | Path) -> ShardIndex:
    """The index of a folder or URL of shards; InputError names what is wrong with it."""
    where = as_url(place) or str(place)
    try:
        content = json.loads(read_at(where, "index.json", MAX_JSON_BYTES))
        if content["version"] != VERSION:
            raise InputError(f"{where}: shards of version {content['version']!r}, this proxnav reads {VERSION}")
        shards = tuple((checked(s["file"]), int(s["frames"]), str(s["sha256"])) for s in content["shards"])
        names = tuple(str(name) for name in content["keypoint_names"])
        documents = {key: content["documents"][key] for key in _DOCUMENTS if key in content["documents"]}
        info = dict(content["info"])
    except InputError:
        raise
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise InputError(f"{where}/index.json: not an index of shards ({type(error).__name__}: {error})") from None
    if not shards or min(count for _, count, _ in shards) < 1:
        raise InputError(f"{where}/index.json: names no shards, or empty ones; convert the set again")
    return ShardIndex(where, shards, names, documents, info)


def write_shards(dataset: Dataset, out: Path, frames_per_shard: int = 1000) -> ShardIndex:
    """A finished data set as shards in `out`, the index last; shards that are there and whole are kept."""
    if frames_per_shard < 1:
        raise InputError(f"a shard needs at least 1 frame, found {frames_per_shard}")
    document = read_json(dataset.folder / "annotations.json", "COCO keypoint annotations")
    entries = {entry["image_id"]: entry for entry in document["annotations"]}
    lines = (dataset.folder / "scenes.jsonl").read_text("utf-8").splitlines() if _has_scenes(dataset) else []
    shards = []
    for start in range(0, len(dataset), frames_per_shard):
        frames = range(start, min(start + frames_per_shard, len(dataset)))
        content = _tar([_stored(dataset, k, document, entries, lines) for k in frames])
        name = f"shard-{len(shards):05d}.tar"
        if len(content) > MAX_SHARD_BYTES:
            raise InputError(f"{name} would have {len(content) / 2**20:.0f} MiB; ask for fewer frames in a shard")
        write_atomic(out / name, content)
        shards.append({"file": name, "frames": len(frames), "sha256": hashlib.sha256(content).hexdigest()})
    found = [name for name in _DOCUMENTS if (dataset.folder / name).is_file()]
    index = {
        "version": VERSION,
        "keypoint_names": list(dataset.keypoint_names),
        "documents": {name: read_json(dataset.folder / name, "a part of the set") for name in found},
        "info": document["info"],
        "shards": shards,
    }
    write_json(out / "index.json", index, indent=1)
    return read_index(out)


def unpack_shards(place: str | Path, out: Path) -> Dataset:
    """Shards as a data set folder, byte for byte as it was."""
    index = read_index(place)
    annotations, names, lines = [], [], []
    for shard in range(len(index.shards)):
        for frame in index.frames(shard):
            write_atomic(inside(out / "images", f"{frame.key}.png"), frame.image)
            write_atomic(inside(out / "masks", f"{frame.key}.png"), frame.mask)
            index.label(frame)  # refuses what is malformed before it is part of a set
            annotations.append(frame.record["annotation"])
            names.append(f"{frame.key}.png")
            lines += [frame.record["scene"]] if "scene" in frame.record else []
    for name, content in index.documents.items():
        write_json(out / name, content, indent=1)
    if len(lines) == len(names):
        write_atomic(out / "scenes.jsonl", "".join(line + "\n" for line in lines).encode())
    from proxnav.geometry import Camera

    camera = Camera.from_speed_json(out / "camera.json")
    sizes = [(camera.width, camera.height)] * len(names)
    write_json(out / "annotations.json", coco.document(annotations, names, sizes, index.keypoint_names))
    return Dataset(out)


def checked(name: Any) -> str:
    """A plain file name; InputError for anything that could lead elsewhere."""
    if not isinstance(name, str) or not name or name != Path(name).name or name.startswith(".") or "\\" in name:
        raise InputError(f"file name {str(name)[:80]!a} in an index of shards is no plain name; refused")
    return name


def _has_scenes(dataset: Dataset) -> bool:
    return (dataset.folder / "scenes.jsonl").is_file()


def _stored(
    dataset: Dataset, k: int, document: dict[str, Any], entries: dict[Any, Any], lines: list[str]
) -> StoredFrame:
    image = document["images"][k]
    name = checked(image["file_name"])
    if not name.endswith(".png") or "." in name.removesuffix(".png"):
        raise InputError(f"{dataset.folder}: shards hold images named NAME.png without other dots, found {name!r}")
    record = {"annotation": entries[image["id"]]} | ({"scene": lines[k]} if lines else {})
    picture = inside(dataset.folder / "images", name).read_bytes()
    return StoredFrame(name.removesuffix(".png"), picture, inside(dataset.folder / "masks", name).read_bytes(), record)


def _tar(frames: list[StoredFrame]) -> bytes:
    """The same frames give the same bytes."""
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w", format=tarfile.USTAR_FORMAT) as tar:
        for frame in frames:
            for part, content in zip(_PARTS, (frame.image, frame.mask, json_bytes(frame.record)), strict=True):
                member = tarfile.TarInfo(f"{frame.key}.{part}")
                member.size, member.mode = len(content), 0o644
                tar.addfile(member, io.BytesIO(content))
    return buffer.getvalue()


def _frames(content: bytes, where: str) -> Iterator[StoredFrame]:
    """Frames whose three parts lie side by side; nothing is ever written to the names in the tar."""
    parts: dict[str, bytes] = {}
    key = ""
    try:
        with tarfile.open(fileobj=io.BytesIO(content), mode="r:") as tar:
            for member in tar:
                name = checked(member.name)
                stem, _, part = name.partition(".")
                file = tar.extractfile(member) if member.isreg() else None
                if file is None or part not in _PARTS or (parts and stem != key):
                    raise InputError(f"{where}: {name!a} is out of place; convert the set again")
                key, parts[part] = stem, file.read()
                if len(parts) == len(_PARTS):
                    yield StoredFrame(key, parts["png"], parts["mask.png"], _record(parts["json"], f"{where}, {key}"))
                    parts = {}
    except (tarfile.TarError, EOFError, OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{where}: not a readable tar ({error}); copy or convert it again") from None
    if parts:
        raise InputError(f"{where}: frame {key!a} is incomplete; convert the set again")


def _record(content: bytes, where: str) -> dict[str, Any]:
    try:
        record = json.loads(content)
    except (ValueError, RecursionError):
        raise InputError(f"{where}: its record is not JSON") from None
    scene = record.get("scene", "") if isinstance(record, dict) else None
    if not isinstance(record, dict) or not isinstance(record.get("annotation"), dict) or not isinstance(scene, str):
        raise InputError(f"{where}: its record needs an annotation, and its scene must be a line of text")
    return record
