"""The EMVA 1288 experiment on the simulated detector: flats and darks in, the camera's parameters out.

EMVA Standard 1288, release 4.0 linear: gain from temporal variance against mean (photon transfer), read noise from the
variance of short darks, dark current from the dark mean against time, PRNU and DSNU from averaged images.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from proxnav.records import ExposureSpec, SensorSpec, Window
from proxnav.sensor.detector import read_out

_QUANTISATION_DN2 = 1.0 / 12.0  # variance of rounding


@dataclass(frozen=True, slots=True)
class PhotonTransfer:
    """What the experiment says about a camera."""

    gain_dn_per_e: float
    """K, slope of the temporal variance over the mean."""
    read_noise_e: float
    dark_current_e_per_s: float
    """At the temperature of the experiment."""
    prnu: float
    dsnu_e: float
    full_well_e: float


def run_photon_transfer(
    sensor: SensorSpec,
    shape: tuple[int, int] = (512, 512),
    temperature_c: float = 25.0,
    flat_levels: int = 16,
    stack: int = 32,
    longest_dark_s: float = 20.0,
) -> PhotonTransfer:
    """Expose the detector to even light and to none, as EMVA 1288 asks, and work out its parameters.

    `shape` is (rows, columns); `stack` images are averaged for each spatial quantity. Particles are kept out. The
    converter must reach above full well, and the black level must keep dark noise above zero, or clipping is measured.
    """
    bench = _Bench(replace(sensor, particle_rate_cm2_s=0.0, blooming=0.0), shape, temperature_c)
    dark_pairs = bench.mean_and_temporal_variance(0.0, 0.0)
    K = _gain(bench, dark_pairs, flat_levels)
    half_well = 0.5 * sensor.full_well_e
    dark, dark_variance = bench.average(0.0, stack)
    flat, flat_variance = bench.average(half_well, stack)
    dsnu2 = dark.var() - dark_variance / stack
    prnu2 = flat.var() - flat_variance / stack - dsnu2
    saturated = bench.image(4.0 * sensor.full_well_e, 0.0, 0)
    return PhotonTransfer(
        gain_dn_per_e=K,
        read_noise_e=float(np.sqrt(dark_pairs[1] - _QUANTISATION_DN2) / K),
        dark_current_e_per_s=_dark_current(bench, longest_dark_s, K),
        prnu=float(np.sqrt(max(prnu2, 0.0)) / (flat.mean() - dark.mean())),
        dsnu_e=float(np.sqrt(max(dsnu2, 0.0)) / K),
        full_well_e=float((saturated.mean() - dark.mean()) / K),
    )


@dataclass(frozen=True, slots=True)
class _Bench:
    """A detector without lens before an even light."""

    sensor: SensorSpec
    shape: tuple[int, int]
    temperature_c: float

    def image(self, electrons: float, dark_s: float, seed: int) -> Float[np.ndarray, "height width"]:
        """One image [DN] of so many mean photo-electrons, after so long in the dark."""
        height, width = self.shape
        signal = np.full(self.shape, electrons, dtype=np.float32)
        exposure = ExposureSpec(temperature_c=self.temperature_c, seed=seed)
        window = Window(0, 0, width, height)
        return read_out(signal, self.sensor, exposure, dark_s, window, (width, height)).astype(np.float64)

    def mean_and_temporal_variance(self, electrons: float, dark_s: float) -> tuple[float, float]:
        """Mean [DN] and temporal variance [DN^2] of a pair of images; the fixed pattern cancels in their difference."""
        seed = 1000 + 2 * int(electrons + 1e6 * dark_s)
        one, other = self.image(electrons, dark_s, seed), self.image(electrons, dark_s, seed + 1)
        return float(0.5 * (one.mean() + other.mean())), float(0.5 * np.var(one - other))

    def average(self, electrons: float, stack: int) -> tuple[Float[np.ndarray, "height width"], float]:
        """Mean image [DN] of a stack, and the temporal variance [DN^2] of one of its images."""
        images = [self.image(electrons, 0.0, 7 + k) for k in range(stack)]
        mean = np.mean(images, axis=0)
        variance = sum(float(((image - mean) ** 2).mean()) for image in images) / (stack - 1)
        return mean, variance


def _gain(bench: _Bench, dark: tuple[float, float], levels: int) -> float:
    """Slope of (variance - dark variance) over (mean - dark mean) through the origin, from 5 % to 70 % of full well.

    Weighted by 1/variance^2, the inverse variance of a sample variance up to a constant.
    """
    light = np.linspace(0.05, 0.7, levels) * bench.sensor.full_well_e
    means, variances = np.array([bench.mean_and_temporal_variance(float(e), 0.0) for e in light]).T
    x, y, weight = means - dark[0], variances - dark[1], 1.0 / variances**2
    return float((weight * x * y).sum() / (weight * x * x).sum())


def _dark_current(bench: _Bench, longest_s: float, K: float) -> float:
    """Slope of the dark mean over time [e-/s]."""
    times = np.linspace(0.0, longest_s, 6)
    means = [bench.mean_and_temporal_variance(0.0, float(t))[0] for t in times]
    return float(np.polyfit(times, means, 1)[0] / K)
