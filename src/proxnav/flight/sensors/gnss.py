"""Relative GNSS: the baseline between a receiver on each craft, over a link between them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from proxnav.flight.sensors.gauss_markov import gauss_markov
from proxnav.flight.truth import Truth
from proxnav.geometry import quaternion
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.records import Antennas, GnssData
from proxnav.records.scene import Triple

_RATE_HZ = 1.0
_OUTAGE_S = 20.0
"""Length of one outage: until another satellite comes from behind the target's body."""


@dataclass(frozen=True)
class GnssConfig:
    """Errors and outages of a grade of receiver; every error is off at zero."""

    sigma_position_m: float = 0.5
    """White noise per axis."""
    sigma_velocity_mps: float = 0.02
    """White noise per axis."""
    bias_sigma_m: float = 0.3
    """Slow error: multipath, orbit and ionosphere residuals."""
    bias_tau_s: float = 300.0
    """How long it lasts."""
    latency_s: tuple[float, float] = (0.1, 1.0)
    """Least and most, uniform."""
    outage_inside_m: float = 30.0
    """Below this range the target's body blocks and reflects..."""
    outage_share: float = 0.5
    """... and this share of the time there is no fix."""
    chaser_antenna_cam_m: Triple = (0.0, -0.15, -0.1)
    """Where the chaser's antenna sits, camera axes."""
    target_antenna_target_m: Triple = (-2.0, 0.0, -1.2)
    """Where the target's antenna sits, target axes."""

    @property
    def antennas(self) -> Antennas:
        """Ends of the baseline, as records tell them."""
        return Antennas(self.chaser_antenna_cam_m, self.target_antenna_target_m)


CODE_GNSS = GnssConfig()
"""Differential pseudoranges."""
CARRIER_GNSS = GnssConfig(
    sigma_position_m=0.02, sigma_velocity_mps=0.005, bias_sigma_m=0.03, bias_tau_s=600.0, latency_s=(0.2, 2.0)
)
"""Differential carrier phase with ambiguities solved."""


def read_gnss(truth: Truth, config: GnssConfig, rng: np.random.Generator) -> GnssData:
    """Baseline between the antennas with slow and white errors; rows in the order of arrival."""
    k = truth.every(_RATE_HZ)
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
    sigmas = np.full(n, config.sigma_position_m), np.full(n, config.sigma_velocity_mps)
    order = np.argsort(received[keep])
    return GnssData(*(column[keep][order] for column in (truth.t[k], received, position, velocity, *sigmas)))


def _turning(q: QuatWxyz, rate: Vector3, arm: Triple) -> Vector3:
    """Velocity of an antenna about its craft's centre of mass, ECI axes [m/s]."""
    return quaternion.rotate(q, np.cross(rate, np.array(arm)))


def _outages(
    range_m: Float[np.ndarray, "n"], dt: float, config: GnssConfig, rng: np.random.Generator
) -> Bool[np.ndarray, "n"]:
    """Whether there is no fix: a slow random process above a level, inside the range of outages."""
    if config.outage_share <= 0.0:
        return np.zeros(len(range_m), dtype=bool)
    slow = gauss_markov(1.0, _OUTAGE_S, dt, (len(range_m),), rng)
    level = np.quantile(slow, 1.0 - config.outage_share) if config.outage_share < 1.0 else -np.inf
    return (range_m < config.outage_inside_m) & (slow >= level)
