"""What each file of sensor records holds: its columns, what is plausible in them, and the record that they make."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from itertools import accumulate
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.datasets.sensor_records.plausibility import Range, Rows
from proxnav.records import (
    AccelerometerData,
    Antennas,
    EphemerisData,
    GnssData,
    GyroData,
    KeypointData,
    PoseData,
    SensorRecords,
    StarTrackerData,
)
from proxnav.storage.tables import quaternion_columns, vector_columns

_UPPER = np.triu_indices(6)
_T, _RECEIVED = ("t_s",), ("received_s",)


@dataclass(frozen=True)
class Table:
    """Columns of one file in blocks, one block a field of the record, and what is plausible in them."""

    blocks: tuple[tuple[str, ...], ...]
    ranges: Mapping[str, Range]
    """Ranges by prefix of the column names."""

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of all columns in order."""
        return tuple(name for block in self.blocks for name in block)

    def split(self, rows: Rows) -> list[Float[np.ndarray, "n ..."]]:
        """The blocks, those of one column flat."""
        parts = np.split(rows, list(accumulate(len(block) for block in self.blocks))[:-1], axis=1)
        return [part[:, 0] if part.shape[1] == 1 else part for part in parts]


TABLES = {
    "ephemeris": Table(
        (_T, vector_columns("r_eci", "m"), vector_columns("v_eci", "mps")),
        {"r_eci": Range(6.4e6, 5e7, "m"), "v_eci": Range(1e3, 1.2e4, "m/s")},
    ),
    "chaser_ephemeris": Table(
        (_T, vector_columns("r_eci", "m"), vector_columns("v_eci", "mps")),
        {"r_eci": Range(6.4e6, 5e7, "m"), "v_eci": Range(1e3, 1.2e4, "m/s")},
    ),
    "gyro": Table((_T, vector_columns("rate", "rad_s")), {"rate": Range(1e-6, 0.3, "rad/s")}),
    "accelerometer": Table(
        (_T, vector_columns("force", "mps2"), ("thrust",)), {"force": Range(0.0, 0.3, "m/s^2", row=50.0)}
    ),
    "gnss": Table(
        (_T, _RECEIVED, vector_columns("r_eci", "m"), vector_columns("v_eci", "mps"), ("sigma_r_m",), ("sigma_v_mps",)),
        {"r_eci": Range(1.0, 2e4, "m"), "v_eci": Range(1e-5, 50.0, "m/s"), "sigma_r": Range(1e-4, 100.0, "m"),
         "sigma_v": Range(1e-6, 10.0, "m/s")},
    ),
    "star_tracker": Table(
        (_T, _RECEIVED, quaternion_columns("q_eci_cam"), vector_columns("sigma", "rad")),
        {"q_eci": Range(0.99, 1.01, "(norm)"), "sigma": Range(1e-7, 0.05, "rad")},
    ),
    "keypoints": Table(
        (_T, _RECEIVED, ("keypoint",), ("u_px", "v_px"), ("cov_uu_px2", "cov_uv_px2", "cov_vv_px2")),
        {"cov_uu": Range(1e-6, 1e5, "px^2"), "cov_vv": Range(1e-6, 1e5, "px^2"), "u_px": Range(0.0, 1e5, "px"),
         "v_px": Range(0.0, 1e5, "px")},
    ),
    "poses": Table(
        (_T, _RECEIVED, quaternion_columns("q_cam_target"), vector_columns("t_cam_target", "m"),
         tuple(f"c{i}{j}" for i, j in zip(*_UPPER, strict=True))),
        {"q_cam": Range(0.99, 1.01, "(norm)"), "t_cam": Range(0.5, 2e4, "m")},
    ),
}  # fmt: skip

_SIMPLE = {
    "ephemeris": EphemerisData, "gyro": GyroData, "accelerometer": AccelerometerData, "gnss": GnssData,
    "star_tracker": StarTrackerData, "chaser_ephemeris": EphemerisData,
}  # fmt: skip
"""Records whose fields are the blocks of their table."""


def rows_of(records: SensorRecords) -> dict[str, Rows]:
    """Rows of the file of each sensor that the craft carries."""
    found = {name: data for name in TABLES if (data := getattr(records, name)) is not None}
    rows = {name: np.column_stack([getattr(data, f.name) for f in fields(data)]) for name, data in found.items()
            if name in _SIMPLE}  # fmt: skip
    if records.keypoints is not None:
        rows["keypoints"] = _keypoint_rows(records.keypoints)
    if (p := records.poses) is not None:
        upper = p.covariance[:, *_UPPER]
        rows["poses"] = np.column_stack([p.t, p.received, p.q_cam_target, p.t_cam_target_m, upper])
    return rows


def records_of(epoch_utc: str, rows: Mapping[str, Rows], antennas: Antennas | None = None) -> SensorRecords:
    """Inverse of `rows_of`; the ephemeris must be there."""
    parts = {name: TABLES[name].split(table) for name, table in rows.items()}
    data: dict[str, Any] = {name: _SIMPLE[name](*blocks) for name, blocks in parts.items() if name in _SIMPLE}
    if "keypoints" in parts:
        data["keypoints"] = _keypoints(*parts["keypoints"])
    if "poses" in parts:
        t, received, q, position, upper = parts["poses"]
        data["poses"] = PoseData(t, received, q, position, _symmetric(upper))
    return SensorRecords(epoch_utc, **data, antennas=antennas)


def _keypoint_rows(data: KeypointData) -> Rows:
    """One row a keypoint that was found."""
    frame, index = np.nonzero(np.isfinite(data.pixels[..., 0]))
    cov = data.covariances_px2[frame, index]
    return np.column_stack(
        [data.t[frame], data.received[frame], index, data.pixels[frame, index], cov[:, 0], cov[:, 1, 1]]
    )


def _keypoints(
    t: Float[np.ndarray, "n"],
    received: Float[np.ndarray, "n"],
    keypoint: Float[np.ndarray, "n"],
    pixels: Float[np.ndarray, "n 2"],
    upper: Float[np.ndarray, "n 3"],
) -> KeypointData:
    """Frames from rows of single keypoints; the frames keep their order of arrival."""
    instants = np.column_stack([t, received])
    frames, first, inverse = np.unique(instants, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")
    place = np.argsort(order)[inverse.ravel()]
    index, count = keypoint.astype(int), int(keypoint.max(initial=-1)) + 1
    all_pixels = np.full((len(frames), count, 2), np.nan)
    all_pixels[place, index] = pixels
    cov = np.full((len(frames), count, 2, 2), np.nan)
    cov[place, index] = upper[:, [0, 1, 1, 2]].reshape(-1, 2, 2)
    return KeypointData(frames[order, 0], frames[order, 1], all_pixels, cov)


def _symmetric(upper: Float[np.ndarray, "n 21"]) -> Float[np.ndarray, "n 6 6"]:
    rows, columns = _UPPER
    out = np.zeros((len(upper), 6, 6))
    out[:, rows, columns] = out[:, columns, rows] = upper
    return out
