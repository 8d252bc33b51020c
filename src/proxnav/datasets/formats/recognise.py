"""Which format a path holds, told by its content; InputError where two would fit or none does."""

from pathlib import Path

import numpy as np

from proxnav.datasets.formats.bop import scene_folders
from proxnav.datasets.formats.bop_results import COLUMNS as BOP_COLUMNS
from proxnav.datasets.formats.named_columns import is_header, pose_columns
from proxnav.datasets.formats.names import is_name
from proxnav.datasets.formats.pose_bowl import refuse_pose_bowl
from proxnav.datasets.formats.row_numbers import numbers
from proxnav.datasets.formats.speed_trees import is_pose_list, pose_files
from proxnav.datasets.formats.tum import is_tum
from proxnav.datasets.formats.urso import POSES
from proxnav.datasets.formats.yolo_pose import YAML
from proxnav.datasets.formats.yolo_read import is_yolo_pose
from proxnav.errors import InputError
from proxnav.storage.files import read_json
from proxnav.storage.tables import read_rows

_NORMALISED = 3.0  # pixels of a keypoint are larger, parts of an image are not
_FOLDERS = (
    "annotations.json (proxnav), data.yaml (YOLO-pose), SPEED+ pose lists, scene_gt.json (BOP) or *_poses_gt.csv (URSO)"
)


def recognise(path: Path) -> str:
    """Name of the format."""
    if path.is_dir():
        return _folder(path)
    if path.suffix.lower() == ".csv":
        return _table(path)
    if path.suffix.lower() in (".yaml", ".yml"):
        return "yolo-pose"
    if path.suffix.lower() in (".tum", ".txt") or (path.suffix.lower() != ".json" and is_tum(path)):
        return "tum"
    return _json(path)


def _folder(path: Path) -> str:
    found = []
    if (path / "annotations.json").is_file():
        found.append("proxnav" if (path / "target.json").is_file() else "coco")
    if scene_folders(path):
        found.append("bop")
    if is_yolo_pose(path / YAML):
        found.append("yolo-pose")
    if any(path.glob(f"*{POSES}")):
        found.append("urso")
    if not found and pose_files(path):
        found.append("speed+")
    if not found and len(tables := [*path.glob("*/splits_krn/*.csv"), *path.glob("*/labels/*.csv")]) > 0:
        raise InputError(f"{path}: name the table to be read, such as {tables[0]}")
    if len(found) != 1:
        raise InputError(f"{path}: holds {' and '.join(found) or 'no known data set'}; expected one of {_FOLDERS}")
    return found[0]


def _json(path: Path) -> str:
    content = read_json(path, "poses or labels")
    if is_pose_list(content):
        return "speed+"
    if isinstance(content, dict) and {"images", "annotations", "categories"} <= set(content):
        return "coco"
    raise InputError(
        f"{path}: neither SPEED+ records (filename, q_vbs2tango_true, r_Vo2To_vbs_true) nor COCO keypoints "
        "(images, annotations, categories)"
    )


def _table(path: Path) -> str:
    rows = read_rows(path)
    head = [cell.lower() for cell in rows[0]]
    if head == [column.lower() for column in BOP_COLUMNS]:
        return "bop-results"
    if path.name.endswith(POSES) or head == ["x", "y", "z", "q1", "q2", "q3", "q4"]:
        return "urso"
    if {"t_s", "q_cam_target_w"} <= set(head):
        return "solution"
    refuse_pose_bowl(head, path)
    if is_header(rows[0]):
        return _by_names(rows, path)
    first = rows[0]
    kind = _by_columns(first, path)
    if kind is None:
        raise InputError(
            f"{path}: rows of {len(first)} columns are none of spec2019 (8), spec2021 and spark (9), bop-results (7), "
            "krn and spnv2 (12 and pairs); give --from FORMAT"
        )
    return kind


def _by_names(rows: list[list[str]], path: Path) -> str:
    """Format of a table with a header."""
    columns = pose_columns(rows[0], None, "wxyz", str(path))
    if {"xmin", "xmax", "ymin", "ymax"} <= {cell.lower() for cell in rows[0]}:
        at = [k for k, cell in enumerate(rows[0]) if cell.lower() in ("xmax", "ymax")]
        box = numbers([rows[1][k] for k in at], f"{path}, row 2") if len(rows) > 1 and len(rows[1]) > max(at) else [0.0]
        return "spnv2" if max(box) < _NORMALISED else "krn"
    if columns.part is None:
        return "spec2019"
    return "spec2021" if rows[0][columns.part].lower() in ("category", "domain") else "spark"


def _by_columns(row: list[str], path: Path) -> str | None:
    if len(row) == 8 and is_name(row[0]):
        return "spec2019"
    if len(row) == 9 and is_name(row[1]) and not is_name(row[0]):
        return "spec2021"
    if len(row) == 9 and is_name(row[0]):
        return "spark"
    if len(row) == 7 and len(row[4].split()) == 9:
        return "bop-results"
    if len(row) >= 12 and len(row) % 2 == 0 and is_name(row[0]):
        box = numbers(row[1:5], f"{path}, row 1")
        return "spnv2" if np.abs(box).max() < _NORMALISED else "krn"
    return None
