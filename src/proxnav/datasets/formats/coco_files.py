"""COCO keypoints: ours (corner-origin pixels, poses beside them), other people's, and the form that detectron2 wants.

detectron2's loader takes keypoints as pixel indices and adds 0.5; torchvision and pycocotools add nothing. Our files
say their origin in info.keypoint_origin; the detectron2 export subtracts 0.5 from u and v, and says so too. Boxes are
edges in every case and are never shifted.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.datasets.formats.labels import (
    LabelRecord,
    Labels,
    from_frame_label,
    need_camera,
    need_keypoints,
    need_pose,
    pixels_of,
    size_of,
    visibility_of,
)
from proxnav.datasets.formats.names import checked_name
from proxnav.datasets.formats.options import ReadOptions, WriteOptions
from proxnav.datasets.formats.places import camera_above, existing, flat_names, mask_beside, place, write_camera
from proxnav.datasets.formats.point_recovery import with_recovered_points
from proxnav.datasets.set import coco
from proxnav.datasets.set.dataset import Dataset
from proxnav.errors import InputError
from proxnav.geometry import Pose
from proxnav.geometry.boxes import box_of_points
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
    times = _times(dataset)
    records = [
        replace(
            from_frame_label(
                label, existing(folder / "images", label.filename), mask_beside(folder / "masks", label.filename)
            ),
            t_s=times.get(label.filename),
        )
        for label in dataset.labels
    ]
    points = options.keypoints_m if options.keypoints_m is not None else dataset.keypoints_m
    return Labels(
        tuple(records), options.camera or dataset.camera, points, dataset.keypoint_names, dataset.target_name, "proxnav"
    )


def _times(dataset: Dataset) -> dict[str, float]:
    """Times of the frames of a sequence [s], by file name."""
    if not (dataset.folder / "scenes.jsonl").is_file():
        return {}
    return {scene.filename: scene.t for scene in dataset.scenes() if scene.sequence}


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
    for record in labels.records:
        need_pose(record, "proxnav")
    labels = with_recovered_points(labels)
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
    names = flat_names(labels.records)
    for record, name in zip(labels.records, names, strict=True):
        place(record.image, folder / "images" / checked_name(name, "coco"), options)
        place(record.mask, folder / "masks" / Path(name).with_suffix(".png"), options)
    sizes = [size_of(record, labels, "coco") for record in labels.records]
    annotations = [_annotation(record, labels, origin) for record in labels.records]
    content = coco.document(annotations, names, sizes, labels.keypoint_names)
    content["info"]["keypoint_origin"] = origin
    write_json(folder / "annotations.json", content)
    write_camera(labels.camera, folder)


def _annotation(record: LabelRecord, labels: Labels, origin: str) -> dict[str, Any] | None:
    """None where the record says nothing of the target."""
    T, pixels = record.T_cam_target, record.keypoints_px
    if T is None and pixels is None:
        return None
    flags, mask = visibility_of(record, labels, "coco"), None if record.mask is None else _mask(record.mask)
    pixels = pixels_of(record, "coco") if pixels is None else pixels
    box = box_of_points(pixels) if record.box_xyxy is None else record.box_xyxy
    if T is None:
        entry = coco.keypoint_annotation(pixels, flags, box, mask)
    else:
        entry = coco.annotation(FrameLabel(record.filename, T, pixels, flags, box), mask)
    if origin == CENTRE:
        shift = np.tile([0.5, 0.5, 0.0], len(pixels))
        entry["keypoints"] = (np.array(entry["keypoints"], dtype=np.float64) - shift).tolist()
    return entry


def _mask(path: Path) -> Mask:
    mask = read_image(path)
    return (mask if mask.ndim == 2 else mask[..., 0]) > 127


def _labels(content: Any, path: Path, options: ReadOptions) -> Labels:
    shift = _shift(content, path, options)
    names = _keypoint_names(content["categories"], options)
    by_image: dict[Any, list[Any]] = {}
    for entry in content["annotations"]:
        if not entry.get("iscrowd"):
            by_image.setdefault(entry["image_id"], []).append(entry)
    records = []
    for image in content["images"]:
        name = checked_name(image["file_name"], str(path))
        record = _record(_one(by_image.get(image["id"], []), name, path, options), name, path, shift)
        records.append(replace(record, size_px=_size(image)))
    camera = options.camera or camera_above(path.parent, levels=0)
    return Labels(tuple(records), camera, options.keypoints_m, names or options.keypoint_names, format="coco")


def _keypoint_names(categories: Any, options: ReadOptions) -> tuple[str, ...]:
    """Names of the category that is asked for, else of the first that has keypoints."""
    asked = [c for c in categories if options.object_id in (None, c.get("id")) and c.get("keypoints")]
    return tuple(str(name) for name in asked[0]["keypoints"]) if asked else ()


def _size(image: Any) -> tuple[int, int] | None:
    size = image.get("width"), image.get("height")
    return (int(size[0]), int(size[1])) if all(isinstance(n, int) and n > 0 for n in size) else None


def _one(entries: list[Any], name: str, path: Path, options: ReadOptions) -> Any:
    if options.object_id is not None:
        entries = [entry for entry in entries if entry.get("category_id") == options.object_id]
    if len(entries) > 1:
        categories = sorted({str(entry.get("category_id")) for entry in entries})
        several = len(categories) > 1
        advice = "say which with --object-id CATEGORY" if several else "an image may show one target; keep one of them"
        raise InputError(
            f"{path}: '{name}' shows {len(entries)} objects of category {', '.join(categories[:8])}; {advice}"
        )
    return entries[0] if entries else None


def _record(entry: Any, name: str, path: Path, shift: float) -> LabelRecord:
    image, mask = _image(path.parent, name), mask_beside(path.parent / "masks", name)
    if entry is None:
        return LabelRecord(name, None, "no_pose", image=image, mask=mask)
    where = f"{path}: annotation of '{name}':"
    if "keypoints" not in entry:
        raise InputError(
            f"{where} has no keypoints; give a COCO file of keypoints, boxes and masks alone are not enough"
        )
    uvf = _triples(entry["keypoints"], where)
    box = finite_numbers(entry.get("bbox", [0.0] * 4), 4, f"{where} bbox")
    x, y, w, h = box
    T = None
    if "q_cam_target" in entry:
        q = finite_numbers(entry["q_cam_target"], 4, f"{where} q_cam_target")
        T = Pose.from_wxyz("cam", "target", q, finite_numbers(entry["t_cam_target"], 3, f"{where} t_cam_target"))
    return LabelRecord(
        name, T, "ok" if T is not None else "no_pose",
        keypoints_px=_labelled(uvf, shift), visibility=uvf[:, 2].astype(np.int64),
        box_xyxy=np.array([x, y, x + w, y + h]) if w > 0 and h > 0 else None, image=image, mask=mask,
    )  # fmt: skip


def _triples(values: Any, where: str) -> Float[np.ndarray, "n_keypoints 3"]:
    numbers = finite_numbers(values, None, f"{where} keypoints")
    if numbers.size == 0 or numbers.size % 3:
        raise InputError(f"{where} keypoints needs [u, v, flag] * n, found {numbers.size} numbers")
    if not np.isin(numbers[2::3], (0.0, 1.0, 2.0)).all():
        raise InputError(f"{where} has a visibility other than 0, 1 and 2; detections with scores go to proxnav solve")
    return numbers.reshape(-1, 3)


def _labelled(uvf: Float[np.ndarray, "n_keypoints 3"], shift: float) -> Float[np.ndarray, "n_keypoints 2"]:
    """Pixels, corner origin; NaN for COCO's "not labelled", which is 0, 0, 0."""
    pixels = uvf[:, :2] + shift
    unlabelled = (uvf[:, 2] == 0.0) & ((uvf[:, :2] == 0.0).all(axis=1) | (pixels == 0.0).all(axis=1))
    return np.where(unlabelled[:, None], np.nan, pixels)


def _image(folder: Path, name: str) -> Path | None:
    """Where COCO sets keep their images: images/ beside the labels or beside their folder, or with the labels."""
    places = (folder / "images", folder, folder.resolve().parent / "images")
    return next((path for place in places if (path := existing(place, name)) is not None), None)


def _shift(content: Any, path: Path, options: ReadOptions) -> float:
    said = {CORNER: "corner", CENTRE: "centre"}.get(content.get("info", {}).get("keypoint_origin"))
    origin = options.pixel_origin or said
    if origin is None:
        raise InputError(
            f"{path}: does not say whether pixel (0, 0) is the first pixel's corner or its centre, which is half a "
            "pixel; give --pixel-origin corner (torchvision) or centre (detectron2, OpenCV)"
        )
    return 0.5 if origin == "centre" else 0.0
