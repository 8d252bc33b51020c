"""Flights on truth that another simulator made, round craft that are less simple than a filter would like."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from proxnav.benchmarks.basilisk_orbits import Flown, RigidBody, fly_pair
from proxnav.benchmarks.monte_carlo import Case, RunResult, judged_run
from proxnav.flight.attitude_motion import WobbleConfig, mean_rates, wobble
from proxnav.flight.faults import with_fault
from proxnav.flight.sensors.ephemeris import read_ephemeris
from proxnav.flight.sensors.star_tracker import StarTrackerConfig
from proxnav.flight.simulate import Grade, SensingConfig, sense
from proxnav.flight.truth import Truth
from proxnav.geometry import Camera, quaternion
from proxnav.geometry.arrays import unit
from proxnav.geometry.celestial import EARTH_EQUATORIAL_RADIUS, MU_EARTH, R_eci_lvlh
from proxnav.geometry.pointing import continuous, q_a_cam_looking
from proxnav.geometry.relative_motion import eci_from_ric
from proxnav.geometry.types import Vector3
from proxnav.navigation.config import NavigationConfig
from proxnav.records import SensorRecords
from proxnav.records.scene import Triple
from proxnav.storage.run_record import plain
from proxnav.targets.loading import load_target

RANGE_M = (11.0, 75.0)
EPOCH = "2026-03-20T12:00:00Z"
_SAMPLE_S = 1.0
_POINTING = WobbleConfig(sigma_deg=0.1, period_s=60.0)
_HELD = WobbleConfig(sigma_deg=0.3, period_s=300.0)
_INERTIA_SIGMA = 0.05
_TENTH = 10
_TRIES = 200


@dataclass(frozen=True)
class OutsideFlight:
    """What is flown, and what of it the filter is not told."""

    perigee_m: float = 400e3
    """Altitude."""
    eccentricity: float = 0.0
    air: float = 1.0
    """Factor on the density of the air at 400 km."""
    tumble_deg_s: float = 0.0
    """Rate of a rigid target about any axis; 0: held, LVLH-fixed."""
    inertia: Triple = (1000.0, 3000.0, 3200.0)
    """As it is thought to be [kg m^2]; the real moments are 5 % off, one sigma."""
    target_centre_m: Triple = (0.0, 0.0, 0.0)
    """Centre of mass of the target, target axes."""
    chaser_centre_cam_m: Triple = (0.0, 0.0, 0.0)
    """Centre of mass of the chaser, camera axes."""
    misalignment_deg: float = 0.0
    """By how much the camera is turned against the body, about any axis."""
    camera_clock_s: float = 0.0
    """Frames are stamped so much late."""
    sensing: SensingConfig = field(default_factory=SensingConfig)
    gnss: Grade = "code"
    fault: Literal["none", "camera_lost", "gnss_lost", "late_camera", "half_turned"] = "none"


@dataclass(frozen=True)
class OutsideJob:
    """Builds, once per process, the function that flies cases. Can be pickled."""

    flight: OutsideFlight
    target: str
    camera: Camera
    filter: NavigationConfig
    seconds: float = 900.0

    def __call__(self) -> Callable[[Case], RunResult]:
        return lambda case: fly_case(case, self)

    @property
    def options(self) -> dict[str, Any]:
        """All that tells its runs from those of another job."""
        return {"seconds": self.seconds, "target": self.target, "flight": plain(self.flight),
                "filter": plain(self.filter)}  # fmt: skip


def fly_case(case: Case, job: OutsideJob) -> RunResult:
    """Flies with Basilisk, senses with our sensors, filters, compares."""
    rng = np.random.default_rng((case.seed, 20261128))
    truth, records = recorded(job.flight, job, rng)
    return judged_run(truth, records, load_target(job.target), job.camera, job.filter)


def recorded(flight: OutsideFlight, job: OutsideJob, rng: np.random.Generator) -> tuple[Truth, SensorRecords]:
    """Truth, and records with what the filter is not told of."""
    truth, centres = outside_truth(flight, job.seconds, rng)
    sensing = replace(flight.sensing, gnss=flight.gnss, star_tracker=StarTrackerConfig(rate_hz=1.0), accelerometer=None)
    records = sense(truth, load_target(job.target), job.camera, sensing, rng)
    records = replace(records, ephemeris=read_ephemeris(centres, rng))
    records = _turned(records, np.deg2rad(flight.misalignment_deg) * unit(rng.normal(size=3)))
    records = _stamped(records, flight.camera_clock_s)
    if flight.fault == "half_turned":
        return truth, _half_turned(records)
    return truth, with_fault(records, flight.fault, rng)


def outside_truth(flight: OutsideFlight, seconds: float, rng: np.random.Generator) -> tuple[Truth, Truth]:
    """The truth of camera and target's origin, and that of both centres of mass."""
    for _ in range(_TRIES):
        target, chaser = _fly(flight, seconds, rng)
        distance = np.linalg.norm(target.r_eci_m - chaser.r_eci_m, axis=1)
        if distance.min() > RANGE_M[0] and distance.max() < RANGE_M[1]:
            return _truth(flight, target, chaser, rng)
    raise AssertionError("no flight of that kind stays in range")


def _fly(flight: OutsideFlight, seconds: float, rng: np.random.Generator) -> tuple[Flown, Flown]:
    perigee = EARTH_EQUATORIAL_RADIUS + flight.perigee_m
    r, v = _orbit(perigee, flight.eccentricity, rng)
    rate = float(np.linalg.norm(np.cross(r, v)) / (r @ r))
    rates = np.deg2rad(flight.tumble_deg_s) * unit(rng.normal(size=3))
    body = RigidBody(r, v, quaternion.random(rng, 1)[0], rates, _moments(flight.inertia, rng))
    rho, rho_dot = _beside(rate, rng)
    other = RigidBody(*eci_from_ric(r, v, rho, rho_dot), np.array([1.0, 0, 0, 0]), np.zeros(3), (1.0, 1.0, 1.0))
    return fly_pair(body, other, seconds, _SAMPLE_S, 4e-12 * flight.air, 400e3)


def _moments(thought: Triple, rng: np.random.Generator) -> Triple:
    """Real moments near those that are thought: none larger than the two others together."""
    for _ in range(_TRIES):
        a, b, c = np.array(thought) * (1.0 + _INERTIA_SIGMA * rng.normal(size=3))
        if 2.0 * max(a, b, c) < a + b + c:
            return a, b, c
    raise AssertionError("no body has such moments")


def _orbit(perigee: float, e: float, rng: np.random.Generator) -> tuple[Vector3, Vector3]:
    """(r, v) anywhere on an orbit in any plane."""
    p, anomaly = perigee * (1.0 + e), rng.uniform(0.0, 2.0 * np.pi)
    c, s = np.cos(anomaly), np.sin(anomaly)
    R = quaternion.to_matrix(quaternion.random(rng, 1)[0])
    r, v = p / (1.0 + e * c) * np.array([c, s, 0.0]), np.sqrt(MU_EARTH / p) * np.array([-s, e + c, 0.0])
    return R @ r, R @ v


def _beside(n: float, rng: np.random.Generator) -> tuple[Vector3, Vector3]:
    """(rho, rho_dot) in RIC axes on an ellipse that would be closed about a circular orbit."""
    radial, cross, centre = rng.uniform(8.0, 20.0), rng.uniform(5.0, 25.0), rng.uniform(-35.0, 35.0)
    a, b = rng.uniform(0.0, 2.0 * np.pi, size=2)
    rho = np.array([radial * np.cos(a), centre - 2.0 * radial * np.sin(a), cross * np.cos(b)])
    rho_dot = n * np.array([-radial * np.sin(a), -2.0 * radial * np.cos(a), -cross * np.sin(b)])
    return rho, rho_dot


def _truth(flight: OutsideFlight, target: Flown, chaser: Flown, rng: np.random.Generator) -> tuple[Truth, Truth]:
    t, n = target.t, len(target.t)
    lvlh = R_eci_lvlh(target.r_eci_m, target.v_eci_mps)
    look = q_a_cam_looking(target.r_eci_m - chaser.r_eci_m, -lvlh[..., 1], target.v_eci_mps)
    q_eci_cam = quaternion.multiply(continuous(look), quaternion.exp(wobble(_POINTING, _SAMPLE_S, n, rng)))
    if flight.tumble_deg_s:
        q_eci_target, rate_target = continuous(target.q_eci_body), target.rate
    else:
        errors = wobble(_HELD, _SAMPLE_S, n, rng)
        q_eci_target = continuous(quaternion.multiply(quaternion.from_matrix(lvlh), quaternion.exp(errors)))
        rate_target = _rates(q_eci_target)
    q_eci_cam = continuous(q_eci_cam)
    centres = Truth(
        EPOCH, t, target.r_eci_m, target.v_eci_mps, chaser.r_eci_m, chaser.v_eci_mps, q_eci_target, q_eci_cam,
        rate_target, mean_rates(q_eci_cam, _SAMPLE_S), np.zeros((n, 3)),
    )  # fmt: skip
    origin, origin_v = _arm(q_eci_target, rate_target, -np.array(flight.target_centre_m))
    eye, eye_v = _arm(q_eci_cam, _rates(q_eci_cam), -np.array(flight.chaser_centre_cam_m))
    return replace(
        centres, r_eci_target_m=target.r_eci_m + origin, v_eci_target_mps=target.v_eci_mps + origin_v,
        r_eci_chaser_m=chaser.r_eci_m + eye, v_eci_chaser_mps=chaser.v_eci_mps + eye_v,
    ), centres  # fmt: skip


def _rates(q: Vector3) -> Vector3:
    """Rates at the samples themselves, body axes [rad/s]: the mean over the step before and the step after."""
    means = mean_rates(q, _SAMPLE_S)
    return 0.5 * (means + np.concatenate([means[1:], means[-1:]]))


def _arm(q: Vector3, rate: Vector3, arm: Vector3) -> tuple[Vector3, Vector3]:
    """(place, velocity) of a point of a body relative to its centre of mass, ECI axes."""
    return quaternion.rotate(q, arm), quaternion.rotate(q, np.cross(rate, arm))


def _turned(records: SensorRecords, turn: Vector3) -> SensorRecords:
    """Star tracker and gyro in the axes that the camera is thought to have: it is turned by `turn` against them."""
    back, stars, gyro = quaternion.exp(-turn), records.star_tracker, records.gyro
    assert stars is not None
    assert gyro is not None
    stars = replace(stars, q_eci_cam=quaternion.multiply(stars.q_eci_cam, back))
    gyro = replace(gyro, rate=quaternion.rotate(quaternion.exp(turn), gyro.rate))
    return replace(records, star_tracker=stars, gyro=gyro)


def _stamped(records: SensorRecords, late_s: float) -> SensorRecords:
    poses, keypoints = records.poses, records.keypoints
    assert poses is not None
    assert keypoints is not None
    poses = replace(poses, t=poses.t + late_s, received=poses.received + late_s)
    keypoints = replace(keypoints, t=keypoints.t + late_s, received=keypoints.received + late_s)
    return replace(records, poses=poses, keypoints=keypoints)


def _half_turned(records: SensorRecords) -> SensorRecords:
    """Every tenth frame shows the target turned by half a turn about its long axis."""
    poses = records.poses
    assert poses is not None
    turned = np.arange(len(poses.t)) % _TENTH == _TENTH - 1
    half = quaternion.multiply(poses.q_cam_target, np.array([0.0, 1.0, 0.0, 0.0]))
    return replace(records, poses=replace(poses, q_cam_target=np.where(turned[:, None], half, poses.q_cam_target)))
