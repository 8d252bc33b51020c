"""Labels and poses from any known file or folder."""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from proxnav.datasets.formats import (
    bop,
    bop_results,
    coco_files,
    krn,
    spark,
    speed_trees,
    spnv2,
    submissions,
    tum,
    urso,
    yolo_read,
)
from proxnav.datasets.formats.attitude import Order, check_order
from proxnav.datasets.formats.consistency import check_consistency
from proxnav.datasets.formats.labels import Labels
from proxnav.datasets.formats.options import ReadOptions
from proxnav.datasets.formats.recognise import recognise
from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.errors import InputError

Reader = Callable[[Path, ReadOptions], Labels]


def _speed(path: Path, options: ReadOptions) -> Labels:
    return speed_trees.read_tree(path, options) if path.is_dir() else speed_trees.read_file(path, options)


def _coco(path: Path, options: ReadOptions) -> Labels:
    return coco_files.read_coco(path / "annotations.json" if path.is_dir() else path, options)


READERS: Mapping[str, tuple[Reader, Order | None]] = {
    "proxnav": (coco_files.read_dataset, "wxyz"),
    "coco": (_coco, "wxyz"),
    "detectron2": (_coco, "wxyz"),
    "speed": (_speed, "wxyz"),
    "speed+": (_speed, "wxyz"),
    "shirt": (_speed, "wxyz"),
    "poses": (_speed, "wxyz"),
    "yolo-pose": (yolo_read.read, "wxyz"),
    "urso": (urso.read, None),  # Unreal axes: no other order of the same four numbers is meant by its inverse
    "krn": (krn.read, "wxyz"),
    "spnv2": (spnv2.read, "wxyz"),
    "spec2019": (submissions.read_2019, "wxyz"),
    "spec2021": (submissions.read_2021, "wxyz"),
    "spark": (spark.read, "xyzw"),
    "bop": (bop.read, None),
    "bop-results": (bop_results.read, None),
    "tum": (tum.read, "xyzw"),
    "solution": (tum.read_solution, None),
}
"""Name to reader and the order of its quaternions; None where there are none, or none to be mistaken."""


def read_labels(path: str | Path, format: str = "auto", options: ReadOptions | None = None) -> Labels:
    """Everything that the file or folder says about its images; InputError where that is not clear.

    Where keypoints or boxes are known, the poses are held against them, and what contradicts is refused by its cause.
    """
    path, options = Path(path), options or ReadOptions()
    if not path.exists():
        raise InputError(f"{path}: no such file or folder")
    name = recognise(path) if format == "auto" else format
    if name not in READERS:
        raise InputError(f"no format '{name}'; one of {', '.join(READERS)}")
    reader, order = READERS[name]
    labels = reader(path, options)
    if not labels.records:
        raise InputError(f"{path}: holds no images ({name})")
    read_as = None if order is None else options.quaternion_order or order
    check_consistency(labels, read_as, str(path))
    if read_as is not None:
        check_order(labels, read_as, str(path))
    return replace(labels, format=name)


def read_pose_records(
    path: str | Path, format: str = "auto", options: ReadOptions | None = None
) -> dict[str, PoseRecord]:
    """Poses by image, true or estimated, of any known file or folder.

    The key is the file name, and `split/filename` where names repeat in the set.
    """
    return pose_records(read_labels(path, format, options), str(path))


def pose_records(labels: Labels, source: str) -> dict[str, PoseRecord]:
    """The poses of labels by image, as `read_pose_records` names them."""
    counts = Counter(record.filename for record in labels.records)
    found: dict[str, PoseRecord] = {}
    for record in labels.records:
        name = record.filename if counts[record.filename] == 1 else f"{record.split}/{record.filename}"
        if name in found:
            raise InputError(f"{source}: '{name}' occurs more than once; each image may have one pose")
        found[name] = PoseRecord(name, record.T_cam_target, record.status, record.covariance)
    return found


def timed(labels: Labels) -> Labels:
    """The labels with their times for names."""
    named = zip(labels.records, tum.times_of(labels), strict=True)
    return replace(labels, records=tuple(replace(r, filename=tum.time_name(t_s)) for r, t_s in named))
