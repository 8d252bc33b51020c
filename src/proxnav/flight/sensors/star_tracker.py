"""A star tracker: the attitude of the camera, now and then."""

from dataclasses import dataclass

import numpy as np

from proxnav.flight.truth import Truth
from proxnav.geometry import quaternion
from proxnav.records import StarTrackerData
from proxnav.records.scene import Triple

_ARCSEC = np.pi / 648000.0
_LATENCY_S = (0.05, 0.2)
"""Least and most, uniform: centroids and matching on the sensor itself."""


@dataclass(frozen=True)
class StarTrackerConfig:
    """A CubeSat star tracker that looks along the camera's y axis."""

    rate_hz: float = 2.0
    sigma_arcsec: Triple = (10.0, 50.0, 10.0)
    """About the camera's x, y and z; the boresight is the worst."""


def read_star_tracker(truth: Truth, config: StarTrackerConfig, rng: np.random.Generator) -> StarTrackerData:
    """Attitude fixes with white errors about the camera's axes."""
    k = truth.every(config.rate_hz)
    sigma = np.array(config.sigma_arcsec) * _ARCSEC
    errors = sigma * rng.normal(size=(len(k), 3))
    received = truth.t[k] + rng.uniform(*_LATENCY_S, size=len(k))
    q = quaternion.multiply(truth.q_eci_cam[k], quaternion.exp(errors))
    return StarTrackerData(truth.t[k], received, q, np.tile(sigma, (len(k), 1)))
