"""Sensors that fix a state now and then: relative GNSS and star tracker."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from proxnav.flight.sensors.gauss_markov import gauss_markov
from proxnav.flight.truth import Truth
from proxnav.geometry import quaternion
from proxnav.records import EphemerisData, GnssData, StarTrackerData
from proxnav.records.scene import Triple

_ARCSEC = np.pi / 648000.0


@dataclass(frozen=True)
class GnssConfig:
    """Relative GNSS: a receiver on each craft and a link between them."""

    rate_hz: float = 1.0
    sigma_position_m: float = 0.5
    """White noise per axis."""
    sigma_velocity_mps: float = 0.02
    bias_sigma_m: float = 0.3
    """Slow error: multipath, orbit and ionosphere residuals."""
    bias_tau_s: float = 300.0
    latency_s: tuple[float, float] = (0.1, 1.0)
    """Least and most, uniform."""
    outage_inside_m: float = 30.0
    """Below this range the target's body blocks and reflects..."""
    outage_share: float = 0.5
    """... and this share of the time there is no fix,"""
    outage_s: float = 20.0
    """in pieces of about this length."""
    chaser_antenna_cam_m: Triple = (0.0, -0.15, -0.1)
    target_antenna_target_m: Triple = (-2.0, 0.0, -1.2)


CODE_GNSS = GnssConfig()
"""Differential pseudoranges."""
CARRIER_GNSS = GnssConfig(
    sigma_position_m=0.02, sigma_velocity_mps=0.005, bias_sigma_m=0.03, bias_tau_s=600.0, latency_s=(0.2, 2.0)
)
"""Differential carrier phase with ambiguities solved."""


@dataclass(frozen=True)
class StarTrackerConfig:
    """A CubeSat star tracker that looks along the camera's y axis."""

    rate_hz: float = 2.0
    sigma_arcsec: Triple = (10.0, 50.0, 10.0)
    """About the camera's x, y and z; the boresight is the worst."""
    latency_s: tuple[float, float] = (0.05, 0.2)


@dataclass(frozen=True)
class EphemerisConfig:
    """The target's orbit as the chaser knows it."""

    interval_s: float = 30.0
    position_sigma_m: float = 20.0
    velocity_sigma_mps: float = 0.02
    """Both constant over the run."""


def read_gnss(truth: Truth, config: GnssConfig, rng: np.random.Generator) -> GnssData:
    """Baseline between the antennas with slow and white errors; rows in the order of arrival."""
    k = every(truth, config.rate_hz)
    dt, n = truth.step_s * float(k[1] - k[0]) if len(k) > 1 else 1.0, len(k)
    arm = quaternion.rotate(truth.q_eci_cam[k], np.array(config.chaser_antenna_cam_m))
    arm = arm - quaternion.rotate(truth.q_eci_target[k], np.array(config.target_antenna_target_m))
    baseline = truth.r_eci_chaser_m[k] - truth.r_eci_target_m[k]
    bias = gauss_markov(config.bias_sigma_m, config.bias_tau_s, dt, (n, 3), rng)
    position = baseline + arm + bias + config.sigma_position_m * rng.normal(size=(n, 3))
    turning = _turning(truth.q_eci_cam[k], truth.rate_cam[k], config.chaser_antenna_cam_m)
    turning = turning - _turning(truth.q_eci_target[k], truth.rate_target[k], config.target_antenna_target_m)
    velocity = (truth.v_eci_chaser_mps - truth.v_eci_target_mps)[k] + turning
    velocity = velocity + config.sigma_velocity_mps * rng.normal(size=(n, 3))
    keep = ~_outages(np.linalg.norm(baseline, axis=1), dt, config, rng)
    received = truth.t[k] + rng.uniform(*config.latency_s, size=n)
    order = np.argsort(received[keep])
    full = np.ones(n)
    columns = (
        truth.t[k],
        received,
        position,
        velocity,
        config.sigma_position_m * full,
        config.sigma_velocity_mps * full,
    )
    return GnssData(*(column[keep][order] for column in columns))


def _turning(q: np.ndarray, rate: np.ndarray, arm: Triple) -> np.ndarray:
    """Velocity of an antenna about its craft's centre of mass, ECI axes [m/s]."""
    return quaternion.rotate(q, np.cross(rate, np.array(arm)))


def read_star_tracker(truth: Truth, config: StarTrackerConfig, rng: np.random.Generator) -> StarTrackerData:
    """Attitude fixes with white errors about the camera's axes."""
    k = every(truth, config.rate_hz)
    sigma = np.array(config.sigma_arcsec) * _ARCSEC
    errors = sigma * rng.normal(size=(len(k), 3))
    received = truth.t[k] + rng.uniform(*config.latency_s, size=len(k))
    q = quaternion.multiply(truth.q_eci_cam[k], quaternion.exp(errors))
    return StarTrackerData(truth.t[k], received, q, np.tile(sigma, (len(k), 1)))


def read_ephemeris(truth: Truth, config: EphemerisConfig, rng: np.random.Generator) -> EphemerisData:
    """The target's orbit with a constant error, the last instant included."""
    k = np.unique(np.r_[every(truth, 1.0 / config.interval_s), len(truth) - 1])
    r = truth.r_eci_target_m[k] + config.position_sigma_m * rng.normal(size=3)
    return EphemerisData(truth.t[k], r, truth.v_eci_target_mps[k] + config.velocity_sigma_mps * rng.normal(size=3))


def every(truth: Truth, rate_hz: float) -> np.ndarray:
    """Indices of truth samples at that rate, from the first."""
    return np.arange(0, len(truth), max(1, round(1.0 / (rate_hz * truth.step_s))))


def _outages(
    range_m: Float[np.ndarray, "n"], dt: float, config: GnssConfig, rng: np.random.Generator
) -> Bool[np.ndarray, "n"]:
    """Whether there is no fix: a slow random process above a level, inside the range of outages."""
    if config.outage_share <= 0.0:
        return np.zeros(len(range_m), dtype=bool)
    slow = gauss_markov(1.0, config.outage_s, dt, (len(range_m),), rng)
    level = np.quantile(slow, 1.0 - config.outage_share) if config.outage_share < 1.0 else -np.inf
    return (range_m < config.outage_inside_m) & (slow >= level)
