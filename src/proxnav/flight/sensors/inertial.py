"""Gyro and accelerometer on the camera's axes."""

from dataclasses import dataclass

import numpy as np

from proxnav.flight.sensors.gauss_markov import gauss_markov
from proxnav.flight.truth import Truth
from proxnav.records import AccelerometerData, GyroData

_DEG_PER_HOUR = np.pi / 180.0 / 3600.0
_BIAS_TAU_S = 1000.0
"""How long a wandering gyro bias lasts: where its Allan deviation is least."""
_MORE_THAN_DRAG = 1e-5  # m/s^2


@dataclass(frozen=True)
class GyroConfig:
    """A tactical gyro (STIM300 class); every error is off at zero."""

    noise_rad_per_sqrt_s: float = 4.36e-5
    """Angle random walk: 0.15 deg/sqrt(h)."""
    turn_on_bias_deg_h: float = 10.0
    """Standard deviation of the constant bias."""
    bias_instability_deg_h: float = 0.5
    """Standard deviation of the wandering bias."""
    scale_sigma: float = 5e-4
    """Scale errors per axis."""
    misalignment_sigma_rad: float = 1e-3
    """Each axis against each other."""


@dataclass(frozen=True)
class AccelerometerConfig:
    """The accelerometer beside that gyro."""

    noise_mps_per_sqrt_s: float = 1.0e-3
    """Velocity random walk: 0.06 m/s/sqrt(h)."""
    bias_sigma_mps2: float = 4.9e-4
    """0.05 mg."""
    scale_sigma: float = 3e-4


def read_gyro(truth: Truth, config: GyroConfig, rng: np.random.Generator) -> GyroData:
    """One reading each truth step: (I + M) w + b + noise."""
    dt, n = truth.step_s, len(truth)
    M = config.misalignment_sigma_rad * rng.normal(size=(3, 3))
    np.fill_diagonal(M, config.scale_sigma * rng.normal(size=3))
    bias = config.turn_on_bias_deg_h * rng.normal(size=3)
    bias = bias + gauss_markov(config.bias_instability_deg_h, _BIAS_TAU_S, dt, (n, 3), rng)
    noise = config.noise_rad_per_sqrt_s / np.sqrt(dt) * rng.normal(size=(n, 3))
    return GyroData(truth.t, truth.rate_cam @ (np.eye(3) + M).T + bias * _DEG_PER_HOUR + noise)


def read_accelerometer(truth: Truth, config: AccelerometerConfig, rng: np.random.Generator) -> AccelerometerData:
    """One reading each truth step, with the state of the thrusters."""
    bias = config.bias_sigma_mps2 * rng.normal(size=3)
    scale = 1.0 + config.scale_sigma * rng.normal(size=3)
    noise = config.noise_mps_per_sqrt_s / np.sqrt(truth.step_s) * rng.normal(size=(len(truth), 3))
    thrust = (np.linalg.norm(truth.specific_force, axis=1) > _MORE_THAN_DRAG).astype(np.float64)
    return AccelerometerData(truth.t, truth.specific_force * scale + bias + noise, thrust)
