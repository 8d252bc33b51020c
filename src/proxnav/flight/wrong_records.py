"""Records as somebody writes them who reads a convention otherwise: clean records, altered."""

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.celestial import R_eci_ric, q_eci_mod
from proxnav.geometry.types import Rotation3x3
from proxnav.records import Antennas, EphemerisData, GnssData, GyroData, PoseData, SensorRecords, StarTrackerData

Mistake = Literal[
    "none", "baseline_negated", "baseline_in_ric", "baseline_in_km", "gyro_permuted", "gyro_swapped", "gyro_reversed",
    "gyro_in_degrees", "gyro_relative", "star_conjugated", "star_scalar_last", "star_mounting_left_out",
    "poses_conjugated", "poses_scalar_last", "poses_inverse", "both_conjugated", "ephemeris_in_teme",
    "chaser_ephemeris_in_teme", "ephemeris_in_gps_time", "ephemerides_exchanged", "camera_clock", "gyro_clock",
    "antennas_of_another_craft",
]  # fmt: skip

CLOCK_S = 0.5
GPS_AHEAD_S = 18.0
_OTHER_ANTENNAS = Antennas((0.3, 0.4, 0.0), (3.0, 1.0, 0.5))

_Change = Callable[[SensorRecords], SensorRecords]


def with_mistake(records: SensorRecords, mistake: Mistake) -> SensorRecords:
    """The records with one convention read otherwise. InputError where they lack the sensor."""
    return MISTAKES[mistake](records)


def _baseline(change: Callable[[SensorRecords, np.ndarray], np.ndarray]) -> _Change:
    def apply(records: SensorRecords) -> SensorRecords:
        g: GnssData = _there(records.gnss, "gnss")
        r, v = change(records, g.position_m), change(records, g.velocity_mps)
        return replace(records, gnss=replace(g, position_m=r, velocity_mps=v))

    return apply


def _in_ric(records: SensorRecords, vectors: np.ndarray) -> np.ndarray:
    g, e = _there(records.gnss, "gnss"), records.ephemeris
    r, v = (np.stack([np.interp(g.t, e.t, c) for c in block.T], axis=1) for block in (e.r_eci_m, e.v_eci_mps))
    return np.einsum("nji,nj->ni", R_eci_ric(r, v), vectors)


def _gyro_axes(M: Rotation3x3) -> _Change:
    def apply(records: SensorRecords) -> SensorRecords:
        g: GyroData = _there(records.gyro, "gyro")
        return replace(records, gyro=replace(g, rate=g.rate @ M.T))

    return apply


def _gyro_relative(records: SensorRecords) -> SensorRecords:
    """Less the turning of the orbital frame."""
    g, s, e = _there(records.gyro, "gyro"), _there(records.star_tracker, "star tracker"), records.ephemeris
    h = np.cross(e.r_eci_m[0], e.v_eci_mps[0])
    turning = h / float(e.r_eci_m[0] @ e.r_eci_m[0])
    k = np.clip(np.searchsorted(s.t, g.t), 0, len(s.t) - 1)
    return replace(
        records, gyro=replace(g, rate=g.rate - quaternion.rotate(quaternion.conjugate(s.q_eci_cam[k]), turning))
    )


def _star(change: Callable[[np.ndarray], np.ndarray]) -> _Change:
    def apply(records: SensorRecords) -> SensorRecords:
        s: StarTrackerData = _there(records.star_tracker, "star tracker")
        return replace(records, star_tracker=replace(s, q_eci_cam=change(s.q_eci_cam)))

    return apply


def _poses(change: Callable[[np.ndarray], np.ndarray]) -> _Change:
    def apply(records: SensorRecords) -> SensorRecords:
        p: PoseData = _there(records.poses, "poses")
        return replace(records, poses=replace(p, q_cam_target=change(p.q_cam_target)))

    return apply


def _poses_inverse(records: SensorRecords) -> SensorRecords:
    p: PoseData = _there(records.poses, "poses")
    back = quaternion.conjugate(p.q_cam_target)
    t = -quaternion.rotate(back, p.t_cam_target_m)
    return replace(records, poses=replace(p, q_cam_target=back, t_cam_target_m=t))


def _scalar_last(q: np.ndarray) -> np.ndarray:
    return np.roll(q, -1, axis=-1)


def _of_date(records: SensorRecords, e: EphemerisData) -> EphemerisData:
    """In mean equator and equinox of date, which TEME is within 20 arcsec."""
    R = quaternion.to_matrix(q_eci_mod(records.epoch_utc, e.t))
    return EphemerisData(
        e.t, np.einsum("nji,nj->ni", R, e.r_eci_m), np.einsum("nji,nj->ni", R, e.v_eci_mps)
    )  # fmt: skip


def _teme(records: SensorRecords) -> SensorRecords:
    return replace(records, ephemeris=_of_date(records, records.ephemeris))


def _chaser_teme(records: SensorRecords) -> SensorRecords:
    chaser: EphemerisData = _there(records.chaser_ephemeris, "ephemeris of the chaser")
    return replace(records, chaser_ephemeris=_of_date(records, chaser))


def _gps_time(records: SensorRecords) -> SensorRecords:
    e = records.ephemeris
    return replace(records, ephemeris=replace(e, t=e.t + GPS_AHEAD_S))


def _exchanged(records: SensorRecords) -> SensorRecords:
    chaser: EphemerisData = _there(records.chaser_ephemeris, "ephemeris of the chaser")
    return replace(records, ephemeris=chaser, chaser_ephemeris=records.ephemeris)


def _camera_clock(records: SensorRecords) -> SensorRecords:
    """The camera stamps its frames too early."""

    def early(data):  # either of two records
        return None if data is None else replace(data, t=data.t - CLOCK_S, received=data.received - CLOCK_S)

    return replace(records, poses=early(records.poses), keypoints=early(records.keypoints))


def _gyro_clock(records: SensorRecords) -> SensorRecords:
    g: GyroData = _there(records.gyro, "gyro")
    return replace(records, gyro=replace(g, t=g.t - CLOCK_S))


def _other_antennas(records: SensorRecords) -> SensorRecords:
    return replace(records, antennas=_OTHER_ANTENNAS)


def _both(records: SensorRecords) -> SensorRecords:
    return _poses(quaternion.conjugate)(_star(quaternion.conjugate)(records))


def _there(data, name: str):  # any record
    if data is None:
        raise InputError(f"these records have no {name}, so nothing can be wrong with it: choose another mistake")
    return data


_HALF_TURN = np.array([0.0, 0.0, 0.0, 1.0])
_CYCLE = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
_SWAP = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])

MISTAKES: dict[Mistake, _Change] = {
    "none": lambda records: records,
    "baseline_negated": _baseline(lambda _, d: -d),
    "baseline_in_ric": _baseline(_in_ric),
    "baseline_in_km": _baseline(lambda _, d: 1e-3 * d),
    "gyro_permuted": _gyro_axes(_CYCLE),
    "gyro_swapped": _gyro_axes(_SWAP),
    "gyro_reversed": _gyro_axes(-np.eye(3)),
    "gyro_in_degrees": _gyro_axes(np.rad2deg(np.eye(3))),
    "gyro_relative": _gyro_relative,
    "star_conjugated": _star(quaternion.conjugate),
    "star_scalar_last": _star(_scalar_last),
    "star_mounting_left_out": _star(lambda q: quaternion.multiply(q, _HALF_TURN)),
    "poses_conjugated": _poses(quaternion.conjugate),
    "poses_scalar_last": _poses(_scalar_last),
    "poses_inverse": _poses_inverse,
    "both_conjugated": _both,
    "ephemeris_in_teme": _teme,
    "chaser_ephemeris_in_teme": _chaser_teme,
    "ephemeris_in_gps_time": _gps_time,
    "ephemerides_exchanged": _exchanged,
    "camera_clock": _camera_clock,
    "gyro_clock": _gyro_clock,
    "antennas_of_another_craft": _other_antennas,
}
