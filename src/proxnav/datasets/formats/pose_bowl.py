"""Pose Bowl csv: chain_id,i,x,y,z,qw,qx,qy,qz; how the camera moved since the first image of its chain.

Not a pose of the target: each chain begins with 0,0,0,1,0,0,0. So it is scored (`evaluation.pose_bowl`), not converted.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from proxnav.datasets.formats.row_numbers import check_width, numbers
from proxnav.errors import InputError
from proxnav.geometry import Pose
from proxnav.storage.tables import read_rows

INDEX, POSE = ("chain_id", "i"), ("x", "y", "z", "qw", "qx", "qy", "qz")
_REFERENCE_TOLERANCE = 1e-6


def is_pose_bowl(header: Sequence[str]) -> bool:
    """Whether a header is that of a Pose Bowl table."""
    return set(INDEX) <= {cell.strip().lower() for cell in header}


def refuse_pose_bowl(header: Sequence[str], path: Path) -> None:
    """InputError for a table that has no poses of a target."""
    if is_pose_bowl(header):
        raise InputError(
            f"{path}: a Pose Bowl table says how the camera moved since the first image of its chain, not where the "
            "target is; it cannot be converted, proxnav evaluate scores two of them"
        )


def read_pose_bowl(path: Path) -> Mapping[tuple[str, int], Pose]:
    """Pose of each image's camera in that of the chain's first image, by (chain_id, i); columns by their names."""
    rows = read_rows(path)
    header = [cell.lower() for cell in rows[0]]
    missing = [name for name in (*INDEX, *POSE) if name not in header]
    if missing or len(set(header)) != len(header):
        raise InputError(f"{path}: a Pose Bowl table has the columns {','.join((*INDEX, *POSE))}, each once")
    chain, index, *place = (header.index(name) for name in (*INDEX, *POSE))
    found: dict[tuple[str, int], Pose] = {}
    for number, row in enumerate(rows[1:], 1):
        where = f"{path}, pose {number}"
        check_width(row, len(header), where, ",".join(header))
        values = numbers([row[k] for k in place], where)
        key = row[chain], round(float(numbers([row[index]], where)[0]))
        if key in found:
            raise InputError(f"{where}: image {key[1]} of chain {key[0][:40]!a} occurs twice")
        norm = float(np.linalg.norm(values[3:]))
        if not abs(norm - 1.0) < 1e-3:
            raise InputError(f"{where}: expected a unit quaternion qw,qx,qy,qz, found norm {norm:.6g}")
        found[key] = Pose.from_wxyz("first", "cam", values[3:] / norm, values[:3])
        if key[1] == 0 and np.abs(values - (0, 0, 0, 1, 0, 0, 0)).max() > _REFERENCE_TOLERANCE:
            raise InputError(f"{where}: image 0 of a chain is its reference, 0,0,0,1,0,0,0")
    return found
