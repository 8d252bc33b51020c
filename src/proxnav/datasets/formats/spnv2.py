"""Csv of SPNv2, without header: filename, xmin, ymin, xmax, ymax, q (wxyz), r [m], then u, v of the target's origin and
of every keypoint. Box and points are parts of the image's width and height. It lies in domain/labels/.
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from proxnav.datasets.formats.keypoint_csv import read_keypoint_rows, write_keypoint_rows
from proxnav.datasets.formats.labels import LabelRecord, Labels, box_of, need_camera, need_pose, pixels_of
from proxnav.datasets.formats.options import ReadOptions, WriteOptions
from proxnav.datasets.formats.places import camera_above, existing, mask_beside
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.types import Box

FOLDER = "labels"
SIDES = ("xmin", "ymin", "xmax", "ymax")


def read(path: Path, options: ReadOptions) -> Labels:
    """Rows; the first point, the origin, is left out because the pose gives it."""
    domain = path.resolve().parents[1 if path.resolve().parent.name == FOLDER else 0]
    split = f"{domain.name}/{path.stem}" if path.resolve().parent.name == FOLDER else path.stem
    camera = options.camera or camera_above(path.parent)
    if camera is None:
        raise InputError(f"{path}: numbers are parts of the image's size, which only a camera tells; give --camera")
    size, records = _size(camera), []
    for row in read_keypoint_rows(path, options.quaternion_order, SIDES):
        record = LabelRecord(
            row.filename, row.T_cam_target, split=split,
            keypoints_px=row.points[1:] * size if len(row.points) else None, box_xyxy=row.box * np.tile(size, 2),
            image=existing(domain / "images", row.filename), mask=mask_beside(domain / "masks", row.filename),
        )  # fmt: skip
        records.append(record)
    return Labels(tuple(records), camera, options.keypoints_m, options.keypoint_names, format="spnv2")


def write(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """One csv per split, camera.json, and the images at full size: SPNv2's own preprocessing makes the small ones."""
    camera = need_camera(labels, "spnv2")
    size = _size(camera)

    def cells(record: LabelRecord, name: str, domain: str) -> tuple[str, Box, Float[np.ndarray, "m 2"]]:
        origin = camera.project(need_pose(record, "spnv2").t_m)
        if not np.isfinite(origin).all():
            raise InputError(f"'{record.filename}': the target's origin is behind the camera; spnv2 cannot hold that")
        points = np.concatenate([origin[None], pixels_of(record, "spnv2")])
        return name, box_of(record, "spnv2") / np.tile(size, 2), points / size

    write_keypoint_rows(labels, folder, options, FOLDER, "spnv2", cells)


def _size(camera: Camera) -> Float[np.ndarray, "2"]:
    return np.array([camera.width, camera.height], dtype=np.float64)
