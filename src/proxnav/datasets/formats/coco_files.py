"""COCO keypoints: ours (corner-origin pixels, poses beside them), other people's, and the form that detectron2 wants.

detectron2's loader takes keypoints as pixel indices and adds 0.5; torchvision and pycocotools add nothing. Our files
say their origin in info.keypoint_origin; the detectron2 export subtracts 0.5 from u and v, and says so too. Boxes are
edges in every case and are never shifted.
"""

from pathlib import Path
from typing import Any

import numpy as np

from proxnav.datasets.formats.labels import LabelRecord, Labels, box_of, from_frame_label, need_camera, need_keypoints
from proxnav.datasets.formats.names import checked_name
from proxnav.datasets.formats.options import ReadOptions, WriteOptions
from proxnav.datasets.formats.places import camera_above, existing, flat_names, mask_beside, place, write_camera
from proxnav.datasets.set import coco
from proxnav.datasets.set.dataset import Dataset
from proxnav.errors import InputError
from proxnav.geometry import Pose
from proxnav.geometry.types import Mask
from proxnav.images.codecs import read_image
from proxnav.records import FrameLabel
from proxnav.storage.files import read_json, write_json
from proxnav.storage.numbers import finite_numbers

CORNER, CENTRE = "pixel corner", "pixel centre"


def read_dataset(folder: Path, options: ReadOptions) -> Labels:
    """A data set folder of ours."""
    dataset = Dataset(folder)
    for label in dataset.labels:
        checked_name(label.filename, str(folder / "annotations.json"))
    records = [
        from_frame_label(
            label, existing(folder / "images", label.filename), mask_beside(folder / "masks", label.filename)
        )
        for label in dataset.labels
    ]
    points = options.keypoints_m if options.keypoints_m is not None else dataset.keypoints_m
    return Labels(
        tuple(records), options.camera or dataset.camera, points, dataset.keypoint_names, dataset.target_name, "proxnav"
    )


def read_coco(path: Path, options: ReadOptions) -> Labels:
    """Any COCO keypoint file with one object per image; images without annotation have no pose."""
    content = read_json(path, "COCO keypoints")
    try:
        return _labels(content, path, options)
    except InputError:
        raise
    except (TypeError, KeyError, IndexError, AttributeError, ValueError, OverflowError) as error:
        raise InputError(f"{path}: not a COCO keypoint file ({type(error).__name__}: {str(error)!a})") from None


def write_dataset(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """A data set folder of ours, without scenes: it was not rendered here."""
    need_camera(labels, "proxnav")
    points = need_keypoints(labels, "proxnav")
    _write(labels, folder, options, CORNER)
    content = {
        "name": labels.target_name,
        "keypoint_names": list(labels.keypoint_names),
        "keypoints_m": points.tolist(),
        "subsets": {},
        "licence": "unknown",
    }
    write_json(folder / "target.json", content, indent=1)


def write_coco(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """annotations.json and images, corner-origin pixels."""
    _write(labels, folder, options, CORNER)


def write_detectron2(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """annotations.json whose keypoints are pixel indices: 0.5 less than ours."""
    _write(labels, folder, options, CENTRE)


def _write(labels: Labels, folder: Path, options: WriteOptions, origin: str) -> None:
    camera = need_camera(labels, "coco")
    names, annotations = flat_names(labels.records), []
    for index, (record, name) in enumerate(zip(labels.records, names, strict=True)):
        place(record.image, folder / "images" / checked_name(name, "coco"), options)
        place(record.mask, folder / "masks" / Path(name).with_suffix(".png"), options)
        if record.T_cam_target is not None:
            annotations.append(_annotation(record, record.T_cam_target, index, origin))
    content = coco.document(annotations, names, camera, labels.keypoint_names)
    content["info"]["keypoint_origin"] = origin
    write_json(folder / "annotations.json", content)
    write_camera(camera, folder)


def _annotation(record: LabelRecord, T: Pose, index: int, origin: str) -> dict[str, Any]:
    pixels, flags = record.keypoints_px, record.visibility
    if pixels is None or flags is None:
        raise InputError(f"coco needs keypoints and '{record.filename}' has none; give --target and --camera")
    label = FrameLabel(record.filename, T, pixels, flags, box_of(record, "coco"))
    entry = coco.annotation(label, index, None if record.mask is None else _mask(record.mask))
    if origin == CENTRE:
        shift = np.tile([0.5, 0.5, 0.0], len(pixels))
        entry["keypoints"] = (np.array(entry["keypoints"], dtype=np.float64) - shift).tolist()
    return entry


def _mask(path: Path) -> Mask:
    mask = read_image(path)
    return (mask if mask.ndim == 2 else mask[..., 0]) > 127


def _labels(content: Any, path: Path, options: ReadOptions) -> Labels:
    shift = _shift(content, path, options)
    names = tuple(str(name) for name in content["categories"][0].get("keypoints", ()))
    by_image: dict[Any, list[Any]] = {}
    for entry in content["annotations"]:
        by_image.setdefault(entry["image_id"], []).append(entry)
    records = []
    for image in content["images"]:
        name = checked_name(image["file_name"], str(path))
        records.append(_record(_one(by_image.get(image["id"], []), name, path, options), name, path, shift))
    points = options.keypoints_m
    camera = options.camera or camera_above(path.parent, levels=0)
    return Labels(tuple(records), camera, points, names or options.keypoint_names, format="coco")


def _one(entries: list[Any], name: str, path: Path, options: ReadOptions) -> Any:
    if options.object_id is not None:
        entries = [entry for entry in entries if entry.get("category_id") == options.object_id]
    if len(entries) > 1:
        raise InputError(f"{path}: '{name}' shows {len(entries)} objects; say which with --object-id CATEGORY")
    return entries[0] if entries else None


def _record(entry: Any, name: str, path: Path, shift: float) -> LabelRecord:
    image, mask = existing(path.parent / "images", name), mask_beside(path.parent / "masks", name)
    if entry is None:
        return LabelRecord(name, None, "no_pose", image=image, mask=mask)
    where = f"{path}: annotation of '{name}':"
    uvf = finite_numbers(entry["keypoints"], None, f"{where} keypoints").reshape(-1, 3)
    x, y, w, h = finite_numbers(entry["bbox"], 4, f"{where} bbox")
    if not np.isin(uvf[:, 2], (0.0, 1.0, 2.0)).all():
        raise InputError(f"{path}: annotation of '{name}' has a visibility other than 0, 1 and 2")
    T = None
    if "q_cam_target" in entry:
        q = finite_numbers(entry["q_cam_target"], 4, f"{where} q_cam_target")
        T = Pose.from_wxyz("cam", "target", q, finite_numbers(entry["t_cam_target"], 3, f"{where} t_cam_target"))
    return LabelRecord(
        name, T, "ok" if T is not None else "no_pose",
        keypoints_px=uvf[:, :2] + shift, visibility=uvf[:, 2].astype(np.int64),
        box_xyxy=np.array([x, y, x + w, y + h]) if w > 0 and h > 0 else None, image=image, mask=mask,
    )  # fmt: skip


def _shift(content: Any, path: Path, options: ReadOptions) -> float:
    said = {CORNER: "corner", CENTRE: "centre"}.get(content.get("info", {}).get("keypoint_origin"))
    origin = options.pixel_origin or said
    if origin is None:
        raise InputError(
            f"{path}: does not say whether pixel (0, 0) is the first pixel's corner or its centre, which is half a "
            "pixel; give --pixel-origin corner (torchvision) or centre (detectron2, OpenCV)"
        )
    return 0.5 if origin == "centre" else 0.0
