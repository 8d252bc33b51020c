"""Tracks that charged particles leave in the silicon."""

import numpy as np
from jaxtyping import Float

from proxnav.records import SensorSpec, Window
from proxnav.sensor import noise

CHARGE_E_PER_M = 80.0e6  # about 80 electrons per micrometre of silicon for a minimum-ionising particle
MEAN_LENGTH_PX = 5.0
LENGTH_LIMITS_PX = (1.0, 60.0)
_STEPS_PER_PX = 4


def mean_count(sensor: SensorSpec, exposure_s: float, detector_size: tuple[int, int]) -> float:
    """Expected hits on a detector (width, height) during exposure and read-out: rate x area x time."""
    area_cm2 = detector_size[0] * detector_size[1] * (sensor.pixel_pitch_m * 100.0) ** 2
    return sensor.particle_rate_cm2_s * area_cm2 * (exposure_s + sensor.readout_s)


def add_tracks(
    electrons: Float[np.ndarray, "height width"],
    sensor: SensorSpec,
    seed: int,
    exposure_s: float,
    window: Window,
    detector_size: tuple[int, int],
) -> None:
    """Add to `electrons` the charge of this exposure's tracks that falls in the window: straight, any direction.

    All tracks of the detector are drawn, so that a window sees the same ones as the full image.
    """
    rng = noise.generator(seed, "particles")
    count = rng.poisson(mean_count(sensor, exposure_s, detector_size))
    start = rng.random((count, 2)) * detector_size
    angle = rng.random(count) * 2.0 * np.pi
    length = np.clip(rng.exponential(MEAN_LENGTH_PX, count), *LENGTH_LIMITS_PX)
    for k in range(count):
        steps = int(np.ceil(length[k] * _STEPS_PER_PX))
        along = (np.arange(steps) + 0.5) / steps * length[k]
        points = start[k] + along[:, None] * (np.cos(angle[k]), np.sin(angle[k]))
        charge = CHARGE_E_PER_M * sensor.pixel_pitch_m * length[k] / steps
        column, row = np.floor(points).astype(np.int64).T - np.array([[window.x], [window.y]])
        inside = (row >= 0) & (row < electrons.shape[0]) & (column >= 0) & (column < electrons.shape[1])
        np.add.at(electrons, (row[inside], column[inside]), np.float32(charge))
