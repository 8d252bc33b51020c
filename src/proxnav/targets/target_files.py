"""A target on disk: target.json for people and programs, mesh.npz for the exact numbers."""

import zipfile
import zlib
from dataclasses import asdict
from pathlib import Path
from typing import Any, get_args

import numpy as np
from jaxtyping import Shaped

from proxnav.errors import InputError
from proxnav.geometry import Pose
from proxnav.storage.files import read_json, replacing, write_json
from proxnav.targets.surface.material import Material, MaterialKind
from proxnav.targets.surface.part_image import PartImage
from proxnav.targets.target import Target

VERSION = 1
MAX_BYTES = 1024 * 2**20
_ARRAYS = ("vertices_m", "faces", "face_part", "corner_normals", "corner_uv_m")
_IMAGE = "image_"
"""Before the part's name, the name of the array of its picture."""


def save_target(target: Target, folder: Path | str) -> Path:
    """Writes target.json and mesh.npz into `folder`, which is made if need be; returns the path of target.json."""
    folder = Path(folder)
    with replacing(folder / "mesh.npz") as part, part.open("wb") as file:
        images = {_IMAGE + name: image.srgb for name, image in target.images.items()}
        np.savez_compressed(file, allow_pickle=False, **{name: getattr(target, name) for name in _ARRAYS}, **images)
    parts = [{"name": n} | asdict(m) for n, m in zip(target.part_names, target.materials, strict=True)]
    content = {
        "version": VERSION,
        "name": target.name,
        "mesh": "mesh.npz",
        "parts": parts,
        "keypoint_names": list(target.keypoint_names),
        "keypoints_m": target.keypoints_m.tolist(),
        "subsets": {name: list(index) for name, index in target.subsets.items()},
        "frames": {
            name: {"q_wxyz": pose.q_wxyz.tolist(), "r_m": pose.t_m.tolist()} for name, pose in target.frames.items()
        },
        "images": {name: {"tile_m": image.tile_m} for name, image in target.images.items()},
        "licence": target.licence,
        "source": target.source,
    }
    write_json(folder / "target.json", content, indent=1)
    return folder / "target.json"


def read_target(path: Path | str) -> Target:
    """The target that `save_target` wrote, number by number."""
    path = Path(path)
    content = _content(path)
    stored = _arrays(path.parent / "mesh.npz")
    arrays = {name: stored[name] for name in _ARRAYS}
    try:
        parts = [dict(part) for part in content["parts"]]
        names = tuple(str(part.pop("name")) for part in parts)
        target = Target(
            name=str(content["name"]),
            **arrays,
            part_names=names,
            materials=tuple(_material(part) for part in parts),
            keypoints_m=np.array(content["keypoints_m"], dtype=np.float64).reshape(-1, 3),
            keypoint_names=tuple(str(name) for name in content["keypoint_names"]),
            subsets={str(k): tuple(int(i) for i in v) for k, v in content.get("subsets", {}).items()},
            licence=str(content.get("licence", "unknown")),
            source=str(content.get("source", "unknown")),
            frames={
                str(name): Pose.from_wxyz("target", str(name), place["q_wxyz"], place["r_m"])
                for name, place in content.get("frames", {}).items()
            },
            images={
                str(name): PartImage(float(image["tile_m"]), stored[_IMAGE + name])
                for name, image in content.get("images", {}).items()
            },
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(
            f"{path}: incomplete or malformed target ({error}); make it again: proxnav target new"
        ) from None
    return _checked(path, target)


def _content(path: Path) -> dict[str, Any]:
    content = read_json(path, "what proxnav target new writes")
    if not isinstance(content, dict) or content.get("version") != VERSION or "parts" not in content:
        raise InputError(f"{path}: holds no mesh of version {VERSION}; expected what proxnav target new writes")
    if content.get("mesh") != "mesh.npz":
        raise InputError(f"{path}: its mesh is {content.get('mesh')!r}; expected mesh.npz beside it")
    return content


def _arrays(path: Path) -> dict[str, Shaped[np.ndarray, "..."]]:
    try:
        with zipfile.ZipFile(path) as archive:
            claimed = sum(entry.file_size for entry in archive.infolist())
        if claimed > MAX_BYTES:
            raise InputError(f"{path}: unpacks to {claimed} bytes; expected at most {MAX_BYTES // 2**20} MiB")
        with np.load(path, allow_pickle=False) as stored:
            images = [name for name in stored.files if name.startswith(_IMAGE)]
            return {name: stored[name] for name in (*_ARRAYS, *images)}
    except InputError:
        raise
    except (OSError, ValueError, KeyError, zipfile.BadZipFile, EOFError, RuntimeError, zlib.error) as error:
        raise InputError(f"{path}: not a readable mesh ({error}); write it again with proxnav target new") from None


def _material(fields: dict[str, Any]) -> Material:
    values: dict[str, Any] = {k: tuple(map(float, v)) if isinstance(v, list) else v for k, v in fields.items()}
    material = Material(**values)
    if material.kind not in get_args(MaterialKind) or len(material.albedo) != 3 or len(material.emission) != 3:
        raise ValueError(f"material {fields}")
    return material


def _checked(path: Path, target: Target) -> Target:
    """Indices within bounds: renderers trust them."""
    limits = (
        ("faces", target.faces, len(target.vertices_m)),
        ("face_part", target.face_part, len(target.part_names)),
        ("subsets", np.array([i for v in target.subsets.values() for i in v], int), len(target.keypoint_names)),
    )
    for name, index, limit in limits:
        if index.size and not 0 <= index.min() <= index.max() < limit:
            raise InputError(f"{path}: {name} point outside the {limit} that exist")
    return target
