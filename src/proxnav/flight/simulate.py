"""A flight's truth, and what every sensor of the chaser says along it."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from proxnav.flight.sensors.detector import DetectorConfig, read_keypoints, read_poses
from proxnav.flight.sensors.ephemeris import read_chaser_ephemeris, read_ephemeris
from proxnav.flight.sensors.gnss import CARRIER_GNSS, CODE_GNSS, read_gnss
from proxnav.flight.sensors.inertial import AccelerometerConfig, GyroConfig, read_accelerometer, read_gyro
from proxnav.flight.sensors.star_tracker import StarTrackerConfig, read_star_tracker
from proxnav.flight.truth import Truth, TruthConfig, simulate_truth
from proxnav.geometry import Camera
from proxnav.geometry.calibration import N_CALIBRATION
from proxnav.records import SensorRecords, Trajectory
from proxnav.targets.target import Target

Detector = Literal["modelled", "raycast"]
"""modelled: keypoints and poses by the statistics of their errors; raycast: frames are rendered and read on the way."""
Grade = Literal["none", "code", "carrier"]

_GRADES = {"code": CODE_GNSS, "carrier": CARRIER_GNSS}


@dataclass(frozen=True)
class SensingConfig:
    """What the chaser carries."""

    detector: DetectorConfig = field(default_factory=DetectorConfig)
    gyro: GyroConfig | None = field(default_factory=GyroConfig)
    accelerometer: AccelerometerConfig | None = field(default_factory=AccelerometerConfig)
    star_tracker: StarTrackerConfig = field(default_factory=StarTrackerConfig)
    gnss: Grade = "code"
    """Relative GNSS by pseudoranges, by carrier phase, or none."""


@dataclass(frozen=True)
class SimulationConfig:
    """Truth and sensors."""

    truth: TruthConfig = field(default_factory=TruthConfig)
    sensing: SensingConfig = field(default_factory=SensingConfig)


def simulate(
    reference: Trajectory, target: Target, camera: Camera, config: SimulationConfig, rng: np.random.Generator
) -> tuple[Truth, SensorRecords]:
    """Flies near the reference and records every sensor."""
    truth = simulate_truth(reference, config.truth, rng)
    return truth, sense(truth, target, camera, config.sensing, rng)


def sense(
    truth: Truth, target: Target, camera: Camera, config: SensingConfig, rng: np.random.Generator
) -> SensorRecords:
    """Readings of all sensors; each draws from a stream of its own, so that leaving one out changes no other.

    What is not known of the camera is drawn once: keypoints and poses are those of a camera that differs from it.
    """
    for_keypoints, for_ephemeris, for_gyro, for_forces, for_gnss, for_stars, for_poses, for_chaser = rng.spawn(8)
    errors = rng.normal(size=N_CALIBRATION) if not camera.calibration_sigma.is_exact else np.zeros(N_CALIBRATION)
    keypoints = read_keypoints(truth, target, camera, config.detector, for_keypoints, errors)
    gnss = _GRADES.get(config.gnss)
    return SensorRecords(
        epoch_utc=truth.epoch_utc,
        ephemeris=read_ephemeris(truth, for_ephemeris),
        chaser_ephemeris=read_chaser_ephemeris(truth, for_chaser) if gnss else None,
        antennas=gnss.antennas if gnss else None,
        gyro=read_gyro(truth, config.gyro, for_gyro) if config.gyro else None,
        accelerometer=read_accelerometer(truth, config.accelerometer, for_forces) if config.accelerometer else None,
        gnss=read_gnss(truth, gnss, for_gnss) if gnss else None,
        star_tracker=read_star_tracker(truth, config.star_tracker, for_stars),
        keypoints=keypoints,
        poses=read_poses(truth, keypoints, target, camera, config.detector, for_poses, errors),
    )
