"""Poses in the spelling of SPEED and SPEED+: `q_vbs2tango[_true]` is q_cam_target (wxyz), `r_Vo2To_vbs_true` is t [m].

Both sets store the quaternion scalar first with X_cam = R(q) X_target + r, R the active Hamilton matrix. A file is a
bare list of records or that list under `poses` (SPIN, SHIRT exports).
"""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry import Pose, quaternion
from proxnav.records.estimates import Trust, Verdict
from proxnav.storage.files import read_json, write_json
from proxnav.storage.numbers import finite_numbers

QUATERNION_KEYS = ("q_vbs2tango_true", "q_vbs2tango")
POSITION_KEY = "r_Vo2To_vbs_true"
_EXPECTED = f"a list of objects with filename, {QUATERNION_KEYS[0]} (wxyz) and {POSITION_KEY}"


@dataclass(frozen=True, slots=True, eq=False)
class PoseRecord:
    """One image's pose, true or estimated; `T_cam_target` is None where there is none, `status` says why."""

    filename: str
    T_cam_target: Pose | None
    status: str = "ok"
    covariance: Float[np.ndarray, "6 6"] | None = None
    """Covariance of (dt [m], dr [rad]), camera frame."""
    trust: Trust | None = None
    """Evidence about an estimate, where there is any."""


def read_poses(path: str | Path) -> dict[str, PoseRecord]:
    """Records by file name, in file order."""
    content = read_json(Path(path), _EXPECTED)
    if isinstance(content, dict):
        content = content.get("poses")
    if not isinstance(content, list):
        raise InputError(f"{path}: expected {_EXPECTED}, or the same under 'poses'")
    records = [_record(entry, f"{path}, record {number}") for number, entry in enumerate(content)]
    by_name = {record.filename: record for record in records}
    if len(by_name) != len(records):
        names = [record.filename for record in records]
        twice = next(name for name in names if names.count(name) > 1)
        raise InputError(f"{path}: '{twice}' occurs more than once; each image may have one pose")
    return by_name


def write_poses(path: str | Path, records: Iterable[PoseRecord]) -> None:
    """A `poses.json`: SPEED+ keys plus status and covariance; w >= 0, null where there is no pose."""
    write_json(Path(path), [_entry(record) for record in records], indent=1)


def _entry(record: PoseRecord) -> dict[str, Any]:
    T, covariance = record.T_cam_target, record.covariance
    entry = {
        "filename": record.filename,
        QUATERNION_KEYS[0]: None if T is None else quaternion.canonical(T.q_wxyz).tolist(),
        POSITION_KEY: None if T is None else T.t_m.tolist(),
        "status": record.status,
        "covariance": None if covariance is None else np.asarray(covariance).tolist(),
    }
    return entry if record.trust is None else entry | {"trust": asdict(record.trust)}


def _record(entry: Any, where: str) -> PoseRecord:
    if not isinstance(entry, Mapping) or not isinstance(entry.get("filename"), str):
        raise InputError(f"{where}: expected an object with a 'filename', found {ascii(entry)[:60]}")
    where = f"{where} ({entry['filename']})"
    key = next((key for key in QUATERNION_KEYS if key in entry), None)
    if key is None or POSITION_KEY not in entry:
        raise InputError(f"{where}: needs {QUATERNION_KEYS[0]} and {POSITION_KEY}, found {', '.join(entry)}")
    status = str(entry.get("status", "ok"))
    if entry[key] is None or entry[POSITION_KEY] is None:
        return PoseRecord(entry["filename"], None, status if status != "ok" else "no_pose")
    q, t_m = _numbers(entry[key], 4, where, key), _numbers(entry[POSITION_KEY], 3, where, POSITION_KEY)
    norm = np.linalg.norm(q)
    if not abs(norm - 1.0) < 1e-4:
        raise InputError(f"{where}: {key} must be a unit quaternion, found norm {norm:.6g}")
    T = Pose.from_wxyz("cam", "target", q, t_m)
    return PoseRecord(entry["filename"], T, status, _covariance(entry, where), _trust(entry.get("trust"), where))


def _covariance(entry: Mapping[str, Any], where: str) -> Float[np.ndarray, "6 6"] | None:
    if entry.get("covariance") is None:
        return None
    return _numbers(entry["covariance"], 36, where, "covariance").reshape(6, 6)


def _trust(content: Any, where: str) -> Trust | None:
    """Evidence about the pose; None where there is none or no protection levels are among it."""
    if not isinstance(content, Mapping) or None in (*(content.get("protection_m") or [None]), content.get("hazard")):
        return None
    known = {name: content.get(name) for name in ("similarity", "hazard", "p_value", "risk")}
    numbers = {name: np.nan if value is None else float(_numbers(value, 1, where, name)[0])
               for name, value in known.items()}  # fmt: skip
    a, b, c = _numbers(content["protection_m"], 3, where, "protection_m").tolist()
    d, e, f = _numbers(content.get("protection_rad"), 3, where, "protection_rad").tolist()
    verdict = next((one for one in get_args(Verdict) if one == content.get("verdict")), None)
    if verdict is None:
        raise InputError(f"{where}: trust needs a verdict among {', '.join(get_args(Verdict))}")
    return Trust(verdict, **numbers, protection_m=(a, b, c), protection_rad=(d, e, f))


def _numbers(value: Any, count: int, where: str, key: str) -> Float[np.ndarray, "n"]:
    return finite_numbers(value, count, f"{where}: {key}")
