"""Errors that forget slowly: first-order Gauss-Markov processes."""

import numpy as np
import scipy  # loads its parts when they are used: signal takes half a second, and help of a command needs none
from jaxtyping import Float


def gauss_markov(
    sigma: float, tau_s: float, dt: float, shape: tuple[int, ...], rng: np.random.Generator
) -> Float[np.ndarray, "*shape"]:
    """Stationary process along the first axis of `shape`: standard deviation sigma, autocorrelation exp(-dt/tau)."""
    keep = np.exp(-dt / tau_s)
    drive = rng.normal(size=shape) * np.sqrt(1.0 - keep * keep)
    drive[0] = rng.normal(size=shape[1:])
    return sigma * np.asarray(scipy.signal.lfilter([1.0], [1.0, -keep], drive, axis=0))
