"""COCO keypoint annotations with the pose beside them; corner-origin pixels, said so in `info`.

Ids of images and annotations count from 1: COCOeval takes annotation 0 for "unmatched". Masks are uncompressed run
lengths, the one form that every usual loader takes and that loses nothing (polygons lose holes).

Extra fields of an annotation: `q_cam_target` (wxyz), `t_cam_target` [m], `visibility` (0 outside, 1 hidden, 2 visible).
Keypoints outside the image keep their projection with COCO's flag 0, so that nothing is lost.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from proxnav.errors import InputError
from proxnav.geometry import Pose, quaternion
from proxnav.geometry.types import Box, Mask
from proxnav.records import FrameLabel
from proxnav.storage.numbers import finite_numbers

VERSION = 1


def annotation(label: FrameLabel, mask: Mask | None) -> dict[str, Any]:
    """One COCO annotation with its pose, still without ids; without a mask the area is the box's."""
    T = label.T_cam_target
    return keypoint_annotation(label.keypoints_px, label.visibility, label.box_xyxy, mask) | {
        "visibility": label.visibility.tolist(),
        "q_cam_target": quaternion.canonical(T.q_wxyz).tolist(),
        "t_cam_target": T.t_m.tolist(),
    }


def keypoint_annotation(
    pixels: Float[np.ndarray, "n_keypoints 2"], visibility: Int[np.ndarray, "n_keypoints"], box: Box, mask: Mask | None
) -> dict[str, Any]:
    """What COCO itself says of one object, without ids; without a mask there is no segmentation."""
    x0, y0, x1, y1 = (float(value) for value in np.nan_to_num(box))
    uv = np.nan_to_num(pixels)
    return {
        "category_id": 1,
        "iscrowd": 0,
        "bbox": [x0, y0, x1 - x0, y1 - y0],
        "area": (x1 - x0) * (y1 - y0) if mask is None else int(mask.sum()),
        "segmentation": [] if mask is None else run_lengths(mask),
        "num_keypoints": int((visibility > 0).sum()),
        "keypoints": [v for (x, y), flag in zip(uv, visibility, strict=True) for v in (float(x), float(y), int(flag))],
    }


def document(
    annotations: Sequence[Mapping[str, Any] | None],
    filenames: Sequence[str],
    sizes: Sequence[tuple[int, int]],
    keypoint_names: Sequence[str],
) -> dict[str, Any]:
    """A whole `annotations.json` with ids from 1, of images in their order, each of a size (width, height) [px]; None
    is an image that shows nothing.
    """
    images = [
        {"id": number, "file_name": name, "width": width, "height": height}
        for number, (name, (width, height)) in enumerate(zip(filenames, sizes, strict=True), 1)
    ]
    entries = [
        {"id": number, "image_id": number} | dict(entry) | {"id": number, "image_id": number}
        for number, entry in enumerate(annotations, 1)
        if entry is not None
    ]
    category = {"id": 1, "name": "target", "keypoints": list(keypoint_names), "skeleton": []}
    info = {"description": "proxnav data set", "version": VERSION, "keypoint_origin": "pixel corner"}
    return {"info": info, "images": images, "annotations": entries, "categories": [category]}


def parse(content: Any, where: str) -> tuple[tuple[str, ...], list[FrameLabel]]:
    """(keypoint names, labels in image order) of an `annotations.json`; InputError names the entry at fault."""
    try:
        version = content["info"].get("version")
        names = tuple(str(name) for name in content["categories"][0]["keypoints"])
        files = {image["id"]: str(image["file_name"]) for image in content["images"]}
        entries = {entry["image_id"]: entry for entry in content["annotations"]}
    except (TypeError, KeyError, IndexError, AttributeError) as error:
        raise InputError(f"{where}: not a COCO keypoint file of proxnav ({type(error).__name__}: {error})") from None
    if version != VERSION:
        raise InputError(f"{where}: format version {version!r}, this proxnav reads {VERSION}: render the set again")
    return names, [_label(entries.get(key), name, len(names), where) for key, name in files.items()]


def _label(entry: Any, filename: str, n_keypoints: int, where: str) -> FrameLabel:
    if entry is None:
        raise InputError(f"{where}: image '{filename}' has no annotation")
    try:
        uvf = finite_numbers(entry["keypoints"], None, "keypoints")
        x, y, w, h = finite_numbers(entry["bbox"], 4, "bbox")
        q = finite_numbers(entry["q_cam_target"], 4, "q_cam_target")
        T = Pose.from_wxyz("cam", "target", q, finite_numbers(entry["t_cam_target"], 3, "t_cam_target"))
    except (TypeError, KeyError, ValueError, OverflowError) as error:
        raise InputError(f"{where}: annotation of '{filename}' is malformed ({error})") from None
    if uvf.shape != (3 * n_keypoints,):
        raise InputError(
            f"{where}: '{filename}' has {uvf.size / 3:g} keypoints, the category names {n_keypoints}; fix the labels"
        )
    uvf = uvf.reshape(-1, 3)
    if not np.isin(uvf[:, 2], (0.0, 1.0, 2.0)).all():
        raise InputError(f"{where}: '{filename}' has a visibility other than 0, 1 and 2; fix the labels")
    box = np.array([x, y, x + w, y + h]) if w > 0 and h > 0 else np.full(4, np.nan)
    return FrameLabel(filename, T, uvf[:, :2], uvf[:, 2].astype(np.int64), box)


def run_lengths(mask: Mask) -> dict[str, Any]:
    """A mask as COCO's uncompressed run lengths: column by column, runs of 0 and 1 in turn, beginning with 0.

    >>> run_lengths(np.array([[False, True], [True, True]]))
    {'size': [2, 2], 'counts': [1, 3]}
    """
    flat = np.concatenate([[0], np.asarray(mask, dtype=np.int8).ravel(order="F")])
    turns = np.flatnonzero(np.diff(flat))
    counts = np.diff(np.concatenate([[0], turns, [mask.size]]))
    return {"size": [int(n) for n in mask.shape], "counts": counts.tolist()}
