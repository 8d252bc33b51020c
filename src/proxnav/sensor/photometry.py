"""From radiance to electrons per second: E = (pi/4) L tau cos^4(theta) / N^2, then mu_e = E A QE lambda / (h c)."""

import numpy as np
from jaxtyping import Float, Float32

from proxnav.geometry import Camera
from proxnav.records import SensorSpec, Window

PLANCK = 6.62607015e-34  # J s, exact (SI 2019)
LIGHT_SPEED = 299_792_458.0  # m/s, exact
BAND_CENTRES_M = np.array([650e-9, 550e-9, 450e-9])  # m, of the bands 600-700, 500-600 and 400-500 nm


def electrons_per_radiance(sensor: SensorSpec) -> Float[np.ndarray, "band=3"]:
    """Electrons per second of a pixel on the axis for 1 W/(m^2 sr) in each band; photons are those of its centre."""
    area_m2 = sensor.pixel_pitch_m**2
    watts = 0.25 * np.pi * sensor.transmission / sensor.f_number**2 * area_m2
    return watts * BAND_CENTRES_M / (PLANCK * LIGHT_SPEED) * np.array(sensor.quantum_efficiency)


def focal_length_m(sensor: SensorSpec, camera: Camera) -> float:
    """Focal length of the lens that gives this sensor behind it the camera's fx."""
    return camera.fx * sensor.pixel_pitch_m


def electron_rate(
    radiance: Float[np.ndarray, "height width band=3"], sensor: SensorSpec
) -> Float32[np.ndarray, "height width *band"]:
    """Expected photo-electrons per second: one number for a mono sensor, three before a Bayer mosaic.

    Mono sums the bands at once: every later optical effect is linear and the same in all bands.
    """
    weights = electrons_per_radiance(sensor).astype(np.float32)
    radiance = np.asarray(radiance, dtype=np.float32)
    if sensor.colour:
        return radiance * weights
    return radiance @ weights


def cos4(camera: Camera, window: Window) -> Float[np.ndarray, "height width"]:
    """cos^4 of the angle of the light in the image space at each pixel's centre, float32.

    The angle behind the lens: tan(theta) = distance from the principal point / f; distortion does not enter.
    """
    x2 = ((np.arange(window.x, window.x + window.width) + 0.5 - camera.cx) / camera.fx) ** 2
    y2 = ((np.arange(window.y, window.y + window.height) + 0.5 - camera.cy) / camera.fy) ** 2
    tan2 = x2.astype(np.float32) + y2.astype(np.float32)[:, None]
    return 1.0 / (1.0 + tan2) ** 2
