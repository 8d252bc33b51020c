"""Labels to any known format, into a folder of their own."""

import shutil
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

from proxnav.datasets.formats import (
    bop_results,
    bop_write,
    coco_files,
    krn,
    spark,
    speed_trees,
    spnv2,
    submissions,
    tum,
    urso,
    yolo_pose,
)
from proxnav.datasets.formats.labels import Labels, with_projected_keypoints
from proxnav.datasets.formats.names import checked_name
from proxnav.datasets.formats.options import WriteOptions
from proxnav.errors import InputError

Writer = Callable[[Labels, Path, WriteOptions], None]

WRITERS: Mapping[str, Writer] = {
    "proxnav": coco_files.write_dataset,
    "coco": coco_files.write_coco,
    "detectron2": coco_files.write_detectron2,
    "speed": speed_trees.write_speed,
    "speed+": speed_trees.write_speedplus,
    "poses": speed_trees.write_poses_json,
    "yolo-pose": yolo_pose.write,
    "urso": urso.write,
    "krn": krn.write,
    "spnv2": spnv2.write,
    "spec2019": submissions.write_2019,
    "spec2021": submissions.write_2021,
    "spark": spark.write,
    "bop": bop_write.write,
    "bop-results": bop_results.write,
    "tum": tum.write,
}


def write_labels(labels: Labels, folder: str | Path, format: str, options: WriteOptions | None = None) -> Path:
    """Writes `labels` into `folder`, which must be empty or absent; returns it.

    Keypoints that the source lacks are projected where pose, camera and the target's points are known.
    """
    folder, options = Path(folder), options or WriteOptions()
    if format not in WRITERS:
        raise InputError(f"cannot write format '{format}'; one of {', '.join(WRITERS)}")
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(f"{folder}: exists and is not an empty folder; give another --out")
    for record in labels.records:
        checked_name(record.filename, format)
    folder.parent.mkdir(parents=True, exist_ok=True)
    unfinished = Path(tempfile.mkdtemp(dir=folder.parent, prefix=f".{folder.name}."))
    try:
        WRITERS[format](with_projected_keypoints(labels), unfinished, options)
        unfinished.chmod(0o755)
        unfinished.replace(folder)  # an empty folder may be replaced; a reader sees all or nothing
    except BaseException:
        shutil.rmtree(unfinished, ignore_errors=True)
        raise
    return folder
