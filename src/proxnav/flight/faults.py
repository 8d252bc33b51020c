"""What goes wrong in flight, done to clean records."""

from collections.abc import Callable
from dataclasses import replace
from typing import Literal, TypeVar

import numpy as np
from jaxtyping import Bool, Int

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.arrays import unit
from proxnav.records import GnssData, KeypointData, PoseData, SensorRecords, StarTrackerData

Fault = Literal[
    "none", "wrong_frames", "camera_lost", "gnss_lost", "gyro_step", "late_camera", "disorder", "half_orbit_dark"
]

_Data = TypeVar("_Data", GnssData, KeypointData, PoseData, StarTrackerData)

WRONG_SHARE = 0.3
GYRO_STEP_DEG_H = 200.0
LATE_S = 2.0
CAMERA_LOST_S = 600.0
DARK_S = 2160.0
ONSET_S = 300.0


def with_fault(records: SensorRecords, fault: Fault, rng: np.random.Generator) -> SensorRecords:
    """The records with a fault; those in time begin after five minutes, in shorter runs at a quarter."""
    return FAULTS[fault](records, rng)


def _unchanged(records: SensorRecords, _: np.random.Generator) -> SensorRecords:
    return records


def _wrong_frames(records: SensorRecords, rng: np.random.Generator) -> SensorRecords:
    """In three of ten frames the detector swaps keypoints, and the pose is wrong by 3 m and 40 deg."""
    k, p = records.keypoints, records.poses
    if k is None:
        raise InputError("the fault wrong_frames swaps keypoints, but these records have none: choose another fault")
    bad = rng.random(len(k.t)) < WRONG_SHARE
    pixels = k.pixels.copy()
    for i in np.flatnonzero(bad):
        seen = np.flatnonzero(np.isfinite(pixels[i, :, 0]))
        pixels[i, seen] = pixels[i, rng.permutation(seen)]
    out = replace(records, keypoints=replace(k, pixels=pixels))
    if p is None:
        return out
    wrong = np.isin(p.t, k.t[bad])
    turn = quaternion.exp(np.deg2rad(40.0) * unit(rng.normal(size=(len(p.t), 3))))
    q = np.where(wrong[:, None], quaternion.multiply(turn, p.q_cam_target), p.q_cam_target)
    shift = 3.0 * unit(rng.normal(size=(len(p.t), 3)))
    return replace(out, poses=replace(p, q_cam_target=q, t_cam_target_m=p.t_cam_target_m + shift * wrong[:, None]))


def _without_camera(seconds: float) -> Callable[[SensorRecords, np.random.Generator], SensorRecords]:
    def apply(records: SensorRecords, _: np.random.Generator) -> SensorRecords:
        first = _onset(records)

        def cut(data: _Data | None) -> _Data | None:
            return None if data is None else rows(data, (data.t < first) | (data.t > first + seconds))

        return replace(records, keypoints=cut(records.keypoints), poses=cut(records.poses))

    return apply


def _gnss_lost(records: SensorRecords, _: np.random.Generator) -> SensorRecords:
    g = records.gnss
    return records if g is None else replace(records, gnss=rows(g, g.t < _onset(records)))


def _gyro_step(records: SensorRecords, rng: np.random.Generator) -> SensorRecords:
    g = records.gyro
    if g is None:
        raise InputError("the fault gyro_step needs a gyro, but these records have none: choose another fault")
    jump = np.deg2rad(GYRO_STEP_DEG_H) / 3600.0 * unit(rng.normal(size=3))
    return replace(records, gyro=replace(g, rate=g.rate + jump * (g.t > _onset(records))[:, None]))


def _late_camera(records: SensorRecords, _: np.random.Generator) -> SensorRecords:
    def later(data: _Data | None) -> _Data | None:
        return None if data is None else replace(data, received=data.t + LATE_S)

    return replace(records, keypoints=later(records.keypoints), poses=later(records.poses))


def _disorder(records: SensorRecords, rng: np.random.Generator) -> SensorRecords:
    """Every fifth message comes twice, and all take between nothing and three seconds."""

    def shaken(data: _Data | None) -> _Data | None:
        if data is None:
            return None
        n = len(data.t)
        twice = np.r_[np.arange(n), np.flatnonzero(rng.random(n) < 0.2)]
        copied = rows(data, twice)
        copied = replace(copied, received=copied.t + rng.uniform(0.0, 3.0, size=len(twice)))
        return rows(copied, np.argsort(copied.received))

    return replace(
        records, keypoints=shaken(records.keypoints), poses=shaken(records.poses), gnss=shaken(records.gnss),
        star_tracker=shaken(records.star_tracker),
    )  # fmt: skip


FAULTS: dict[Fault, Callable[[SensorRecords, np.random.Generator], SensorRecords]] = {
    "none": _unchanged,
    "wrong_frames": _wrong_frames,
    "camera_lost": _without_camera(CAMERA_LOST_S),
    "gnss_lost": _gnss_lost,
    "gyro_step": _gyro_step,
    "late_camera": _late_camera,
    "disorder": _disorder,
    "half_orbit_dark": _without_camera(DARK_S),
}


def rows(data: _Data, index: Bool[np.ndarray, "n"] | Int[np.ndarray, "m"]) -> _Data:
    """The same record with some of its rows."""
    return type(data)(*(getattr(data, name)[index] for name in data.__dataclass_fields__))


def _onset(records: SensorRecords) -> float:
    t = records.ephemeris.t
    return float(t.min() + min(0.25 * (t.max() - t.min()), ONSET_S))
