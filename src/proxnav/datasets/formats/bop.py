"""BOP scenewise, read: millimetres, rotations row by row, X_cam = R X_model + t; masks and boxes per instance.

The ids are BOP's, the names 000012.png; our export keeps the name, the lens and the pixel origin in extra keys.
"""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.datasets.formats.bop_units import check_millimetres, say_rounding
from proxnav.datasets.formats.labels import LabelRecord, Labels
from proxnav.datasets.formats.names import checked_name
from proxnav.datasets.formats.options import ReadOptions
from proxnav.datasets.formats.places import existing
from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.geometry.pose import rounding_of
from proxnav.geometry.types import Box
from proxnav.storage.files import read_json
from proxnav.storage.numbers import finite_numbers
from proxnav.targets.keypoints.point_files import load_points

MM = 1000.0
_MAX_SCENES = 10_000
_ENDINGS = (".png", ".jpg", ".jpeg", ".tif")


def scene_folders(folder: Path) -> list[Path]:
    """Folders with a scene_gt.json: the folder itself, its scenes, or the scenes of its splits."""
    found = [path.parent for depth in ("", "*/", "*/*/") for path in sorted(folder.glob(f"{depth}scene_gt.json"))]
    if len(found) > _MAX_SCENES:
        raise InputError(f"{folder}: more than {_MAX_SCENES} scenes; give one split or scene")
    return found


def read(folder: Path, options: ReadOptions) -> Labels:
    """All scenes below `folder`; one camera for all, one object per image."""
    records: list[LabelRecord] = []
    camera, roundings = options.camera, [0.0]
    for scene in scene_folders(folder):
        try:
            camera = _read_scene(scene, folder, options, camera, records, roundings)
        except InputError:
            raise
        except (KeyError, TypeError, ValueError, AttributeError, IndexError, OverflowError) as error:
            raise InputError(f"{scene}: not a BOP scene ({type(error).__name__}: {str(error)!a})") from None
    check_millimetres(records, camera, folder)
    say_rounding(max(roundings), folder)
    points, names = options.keypoints_m, options.keypoint_names
    if points is None and (folder / "keypoints.json").is_file():
        points, names = load_points(folder / "keypoints.json")
    return Labels(tuple(records), camera, points, names, format="bop")


def _read_scene(
    scene: Path,
    root: Path,
    options: ReadOptions,
    camera: Camera | None,
    records: list[LabelRecord],
    roundings: list[float],
) -> Camera | None:
    truth = read_json(scene / "scene_gt.json", "BOP poses by image")
    cameras = read_json(scene / "scene_camera.json", "BOP cameras by image")
    infos = _optional(scene / "scene_gt_info.json")
    split = scene.resolve().relative_to(root.resolve()).as_posix().removeprefix(".")
    keys = sorted(truth, key=int)
    size = _size(scene, int(keys[0])) if keys and options.camera is None else (0, 0)
    for key in keys:
        where = f"{scene / 'scene_gt.json'}, image {key}"
        own = options.camera or _camera(cameras[key], size)
        if camera is not None and own != camera:
            raise InputError(f"{where}: another camera than the images before; convert one camera at a time")
        camera = own
        index, entry = _chosen(truth[key], where, options)
        info = infos[key][index] if key in infos and entry is not None else {}
        if entry is not None:
            roundings.append(rounding_of(finite_numbers(entry["cam_R_m2c"], 9, where).reshape(3, 3)))
        records.append(_record(scene, int(key), split, cameras[key], index, entry, info, where))
    return camera


def _record(
    scene: Path, key: int, split: str, camera: Any, index: int, entry: Any, info: Any, where: str
) -> LabelRecord:
    image, mask = _image(scene, key), existing(scene / "mask", f"{key:06d}_{index:06d}.png")
    name = checked_name(camera.get("file_name") or (image.name if image else f"{key:06d}.png"), where)
    if entry is None:
        return LabelRecord(name, None, "no_pose", split, image=image)
    return LabelRecord(name, _pose(entry, where), split=split, box_xyxy=_box(info, where), image=image, mask=mask)


def _chosen(entries: Any, where: str, options: ReadOptions) -> tuple[int, Any]:
    """(place in the list, entry) of the one object; (0, None) where the image shows none."""
    fit = [
        (i, entry) for i, entry in enumerate(entries) if options.object_id in (None, entry.get("obj_id"))
    ]  # fmt: skip
    if len(fit) > 1:
        ids = ", ".join(str(entry.get("obj_id")) for _, entry in fit[:8])
        raise InputError(f"{where}: {len(fit)} objects (ids {ids}); say which with --object-id")
    return fit[0] if fit else (0, None)


def _pose(entry: Any, where: str) -> Pose:
    R = finite_numbers(entry["cam_R_m2c"], 9, f"{where}: cam_R_m2c").reshape(3, 3)
    t_mm = finite_numbers(entry["cam_t_m2c"], 3, f"{where}: cam_t_m2c")
    try:
        return Pose.from_rounded_matrix("cam", "target", R, t_mm / MM)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _camera(entry: Any, size: tuple[int, int]) -> Camera:
    """The camera of one image, with its own K and the set's size (width, height)."""
    K = finite_numbers(entry["cam_K"], 9, "cam_K").reshape(3, 3)
    width, height = size
    shift = 0.5 if entry.get("pixel_origin") == "centre" else 0.0
    distortion = tuple(finite_numbers(entry.get("distortion", (0.0,) * 5), None, "distortion").tolist())
    cx, cy = float(K[0, 2]) + shift, float(K[1, 2]) + shift
    return Camera(width, height, float(K[0, 0]), float(K[1, 1]), cx, cy, distortion, entry.get("projection", "pinhole"))


def _size(scene: Path, key: int) -> tuple[int, int]:
    """(width, height) of the set's camera.json, else of image `key`."""
    for folder in (scene, *scene.resolve().parents[:2]):
        content = _optional(folder / "camera.json")
        if "width" in content and "height" in content:
            return int(content["width"]), int(content["height"])
    image = _image(scene, key)
    if image is None:
        raise InputError(f"{scene}: neither a camera.json with width and height nor images; give --camera")
    from proxnav.images.codecs import read_image

    height, width = read_image(image).shape[:2]
    return width, height


def _image(scene: Path, key: int) -> Path | None:
    paths = (existing(scene / kind, f"{key:06d}{ending}") for kind in ("rgb", "gray") for ending in _ENDINGS)
    return next((path for path in paths if path is not None), None)


def _box(info: Any, where: str) -> Box | None:
    if "bbox_obj" not in info:
        return None
    x, y, w, h = finite_numbers(info["bbox_obj"], 4, f"{where}: bbox_obj of scene_gt_info.json")
    return np.array([x, y, x + w, y + h]) if w > 0 and h > 0 else None


def _optional(path: Path) -> Any:
    return read_json(path, "BOP JSON") if path.is_file() else {}


def image_number(name: str) -> int:
    """The last whole number in a file's name: 12 of img000012.png.

    >>> image_number("img000012.png")
    12
    """
    digits = re.findall(r"\d+", Path(name).stem)
    if not digits or len(digits[-1]) > 12:
        raise InputError(f"'{name}' holds no number to be BOP's image id; number the images, as in img000012.png")
    return int(digits[-1])


def to_json_lines(entries: dict[int, Any]) -> bytes:
    """BOP's own layout: one image a line."""
    rows = ",\n".join(f'  "{key}": {json.dumps(value, allow_nan=False)}' for key, value in sorted(entries.items()))
    return f"{{\n{rows}\n}}\n".encode()
