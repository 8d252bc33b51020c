"""The filter beside a stream: records of the other sensors, and each pose as it comes."""

from dataclasses import dataclass, replace
from pathlib import Path

from proxnav.datasets.sensor_records.record_files import read_other_records
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.epochs import parse_iso
from proxnav.geometry.types import Points
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import Ephemeris, setup_of
from proxnav.navigation.grown_ephemeris import reaches
from proxnav.navigation.navigator import Navigator, other_orbit
from proxnav.navigation.readings import PoseFix, Reading
from proxnav.navigation.stream import monitored
from proxnav.records import NavState, PoseResult


@dataclass(slots=True)
class Fused:
    """`fused(t, result)`: the state after all readings up to t, by the stream's clock, and the pose of t."""

    navigator: Navigator
    ephemeris: Ephemeris
    readings: list[Reading]
    epoch_s: float
    """What the stream's times are at the records' epoch: its seconds since 1970, or 0 where both count from there."""
    place: int = 0
    """First reading that the filter has not got."""

    @staticmethod
    def of(folder: Path, points_m: Points, camera: Camera, config: NavigationConfig, counts_from_1970: bool) -> "Fused":
        """The filter over a folder of records as `navigate` reads it; poses and keypoints of files are left aside."""
        records = replace(read_other_records(folder).records, poses=None, keypoints=None)
        setup = setup_of(records, points_m, camera, config)
        readings = monitored(records, setup)
        if not readings:
            raise InputError(f"{folder}: holds no readings of any sensor; give the records of the flight")
        epoch_s = parse_iso(records.epoch_utc) - parse_iso("1970-01-01T00:00:00Z") if counts_from_1970 else 0.0
        navigator = Navigator(setup, min(one.t for one in readings), other=other_orbit(records))
        return Fused(navigator, setup.ephemeris, readings, epoch_s)

    def __call__(self, t: float, result: PoseResult) -> NavState | None:
        """The newest state; None before the first pose, and beyond the records' ephemeris."""
        t -= self.epoch_s
        while self.place < len(self.readings) and self.readings[self.place].received <= t:
            self.navigator.put(self.readings[self.place])
            self.place += 1
        pose = result.T_cam_target
        if pose is not None and result.covariance is not None:
            self.navigator.put(PoseFix(t, t, pose.q_wxyz, pose.t_m, result.covariance))
        return self.navigator.at(t) if reaches(self.ephemeris, t) else None
