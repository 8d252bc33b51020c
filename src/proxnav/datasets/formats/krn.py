"""Csv of the SPEED+ baseline's keypoint regression network, without header, pixels.

domain/images/file, xmin, xmax, ymin, ymax, q (wxyz), r [m], u0, v0, u1, v1, ...: mind the order of the box.
It lies in domain/splits_krn/.
"""

from pathlib import Path, PurePosixPath

from proxnav.datasets.formats.keypoint_csv import read_keypoint_rows, write_keypoint_rows
from proxnav.datasets.formats.labels import LabelRecord, Labels, box_of, pixels_of
from proxnav.datasets.formats.names import checked_name
from proxnav.datasets.formats.options import ReadOptions, WriteOptions
from proxnav.datasets.formats.places import camera_above, existing, mask_beside

FOLDER = "splits_krn"
SIDES = ("xmin", "xmax", "ymin", "ymax")
_BOX = [0, 2, 1, 3]  # x0, y0, x1, y1 from x0, x1, y0, y1 and back


def read(path: Path, options: ReadOptions) -> Labels:
    """Rows; domain and file name make the split, as in `synthetic/train`."""
    root, records = path.resolve().parents[2 if path.resolve().parent.name == FOLDER else 0], []
    for row in read_keypoint_rows(path, options.quaternion_order, SIDES):
        parts = PurePosixPath(row.filename).parts
        at = parts.index("images") if "images" in parts else 0
        domain, name = "/".join(parts[:at]), "/".join(parts[at + 1 :] if "images" in parts else parts)
        name = checked_name(name, str(path))
        record = LabelRecord(
            name, row.T_cam_target, split=f"{domain}/{path.stem}" if domain else path.stem,
            keypoints_px=row.points if len(row.points) else None, box_xyxy=row.box[_BOX],
            image=existing(root, row.filename), mask=mask_beside(root / domain / "masks", name),
        )  # fmt: skip
        records.append(record)
    camera = options.camera or camera_above(path.parent)
    return Labels(tuple(records), camera, options.keypoints_m, options.keypoint_names, format="krn")


def write(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """One csv per split, the images, and camera.json."""
    write_keypoint_rows(
        labels, folder, options, FOLDER, "krn",
        lambda r, name, domain: (f"{domain}/images/{name}", box_of(r, "krn")[_BOX], pixels_of(r, "krn")),
    )  # fmt: skip
