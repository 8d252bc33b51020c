"""Process noise as the compiled prediction takes it, and what of it nobody can choose."""

import numpy as np
from jaxtyping import Float

from proxnav.navigation.config import NavigationConfig

SLOW_ACCELERATION = (2e-8, 2.5e-7, 2e-8)
"""Differential drag [m/s^2, one sigma] in RIC axes, a first-order Gauss-Markov process; it acts along the flight."""
SLOW_TAU_S = 3000.0
"""How long it lasts: about half a revolution, over which density changes from day to night."""
RATE_WALK_WITHOUT_GYRO = 1.1e-4
"""Wandering of the camera's own rate where no gyro measures it [rad/s per sqrt(s)], as its pointing control shows."""

UNKNOWN_INERTIA = 0.4
"""Angular acceleration of a free body whose inertia nobody knows, per axis and one sigma, as a share of its squared
rate: between the 0.5 of a plate and the 0.3 of a long box."""

(
    ACCELERATION_PSD, GYRO_PSD, BIAS_PSD, RATE_PSD, GNSS_SIGMA, GNSS_TAU, CAMERA_TAU, ANGLE_VAR,
    CALIBRATION, TURN_SHARE,
) = range(10)  # fmt: skip
SLOW_VARIANCE = slice(10, 13)
"""Places in `noise_vector`."""


def noise_vector(config: NavigationConfig, has_gyro: bool, n_calibration: int = 0) -> Float[np.ndarray, "13"]:
    """Power densities, standard deviations and time constants, SI.

    Behind them: a variance that one step adds to angles; how many errors of the camera's calibration there are, which
    never change; the target's unmodelled angular acceleration as a share of its squared rate; variances of the slow
    acceleration.
    """
    n = config.noise
    noise = np.zeros(SLOW_VARIANCE.stop)
    noise[ACCELERATION_PSD] = n.acceleration**2
    noise[GYRO_PSD] = n.gyro**2 if has_gyro else 0.0
    noise[BIAS_PSD] = (n.gyro_bias_walk if has_gyro else RATE_WALK_WITHOUT_GYRO) ** 2
    noise[RATE_PSD] = (config.held.rate_walk if config.target == "held" else n.free_rate_walk) ** 2
    noise[GNSS_SIGMA], noise[GNSS_TAU] = n.gnss_bias_m, n.gnss_tau_s
    noise[CAMERA_TAU] = n.camera.tau_s if config.coupling == "tight" else n.poses.tau_s
    noise[CALIBRATION] = n_calibration
    if config.target == "free":
        noise[TURN_SHARE] = UNKNOWN_INERTIA if config.inertia is None else config.inertia_sigma
    noise[SLOW_VARIANCE] = np.square(SLOW_ACCELERATION)
    return noise
