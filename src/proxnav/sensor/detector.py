"""The detector of the EMVA 1288 linear model: from expected photo-electrons to digital numbers."""

import math

import numpy as np
from jaxtyping import Float, UInt8, UInt16

from proxnav.geometry.compiled.kernel import kernel
from proxnav.records import ExposureSpec, SensorSpec, Window
from proxnav.sensor import noise
from proxnav.sensor.blooming import spill
from proxnav.sensor.particles import add_tracks

Counts = UInt8[np.ndarray, "height width"] | UInt16[np.ndarray, "height width"]


def dark_electrons(sensor: SensorSpec, exposure: ExposureSpec, exposure_s: float) -> float:
    """Mean dark charge [e-] of one exposure: mu_I(T) t, mu_I doubling every `dark_doubling_c` kelvin (EMVA 1288)."""
    doublings = (exposure.temperature_c - sensor.dark_reference_c) / sensor.dark_doubling_c
    return sensor.dark_current_e_per_s * 2.0**doublings * exposure_s


def gain_e_per_dn(sensor: SensorSpec) -> float:
    """Electrons per digital number, 1/K; the full well fills the converter's range unless the sensor says otherwise."""
    if sensor.gain_e_per_dn > 0.0:
        return sensor.gain_e_per_dn
    return sensor.full_well_e / (2**sensor.bits - 1 - sensor.black_level_dn)


def read_out(
    signal_e: Float[np.ndarray, "height width"],
    sensor: SensorSpec,
    exposure: ExposureSpec,
    exposure_s: float,
    window: Window,
    detector_size: tuple[int, int],
) -> Counts:
    """Digital numbers from the expected photo-electrons of the pixels in `window` of a detector (width, height)."""
    electrons = collect(signal_e, sensor, exposure, exposure_s, window)
    if sensor.particle_rate_cm2_s > 0.0:
        add_tracks(electrons, sensor, exposure.seed, exposure_s, window, detector_size)
    spill(electrons, sensor.full_well_e, sensor.blooming)
    return digitise(electrons, sensor, exposure, window)


def collect(
    signal_e: Float[np.ndarray, "height width"],
    sensor: SensorSpec,
    exposure: ExposureSpec,
    exposure_s: float,
    window: Window,
) -> Float[np.ndarray, "height width"]:
    """Charge [e-] of each pixel: one Poisson draw of photo-electrons times (1 + PRNU) plus dark charge times hot map.

    Dead pixels have no photo-electrons.

    The sum of two independent Poisson numbers is Poisson of the summed mean, so one draw serves both.
    """
    electrons = np.empty(signal_e.shape, dtype=np.float32)
    keys = [noise.stream_key(sensor.serial, name) for name in ("prnu", "hot", "dead")]
    shot = noise.stream_key(exposure.seed, "shot")
    dark = dark_electrons(sensor, exposure, exposure_s)
    signal = np.ascontiguousarray(signal_e, dtype=np.float32)
    if sensor.dead_pixel_share > 0.0:
        signal = _without_dead(signal, window.x, window.y, keys[2], sensor.dead_pixel_share)
    _collect(signal, electrons, window.x, window.y, keys[0], keys[1], shot, sensor.prnu, dark, sensor.hot_pixel_share)
    return electrons


def digitise(
    electrons: Float[np.ndarray, "height width"], sensor: SensorSpec, exposure: ExposureSpec, window: Window
) -> Counts:
    """Read noise, fixed offsets, gain, black level, rounding and clipping to [0, 2^bits - 1]."""
    height, width = electrons.shape
    dn = np.empty((height, width), dtype=np.uint8 if sensor.bits <= 8 else np.uint16)
    rows = _line_offsets(noise.stream_key(sensor.serial, "rows"), window.y, height) * sensor.row_noise_dn
    columns = _line_offsets(noise.stream_key(sensor.serial, "columns"), window.x, width)
    columns = columns * sensor.column_noise_dn + sensor.black_level_dn
    read, dsnu = noise.stream_key(exposure.seed, "read"), noise.stream_key(sensor.serial, "dsnu")
    K = 1.0 / gain_e_per_dn(sensor)
    white = 2.0**sensor.bits - 1.0
    _digitise(
        electrons, dn, window.x, window.y, read, dsnu, sensor.read_noise_e, sensor.dsnu_e, K, rows, columns, white
    )
    return dn


@kernel
def _without_dead(signal, x0, y0, key, share):
    out = signal.copy()
    for i in range(out.shape[0]):
        row = noise.line_key(key, y0 + i)
        for j in range(out.shape[1]):
            if noise.uniform(noise.pixel_bits(row, x0 + j)) < share:
                out[i, j] = 0.0
    return out


_HOT_LOG_LOW, _HOT_LOG_SPAN = math.log(1e2), math.log(1e5 / 1e2)


@kernel
def _collect(signal, electrons, x0, y0, prnu_key, hot_key, shot_key, prnu, dark, hot_share):
    height, width = signal.shape
    for i in range(height):
        prnu_row = noise.line_key(prnu_key, y0 + i)
        hot_row = noise.line_key(hot_key, y0 + i)
        shot_row = noise.line_key(shot_key, y0 + i)
        for j in range(width):
            mean = max(np.float64(signal[i, j]), 0.0)
            if prnu > 0.0 and mean > 0.0:
                mean *= max(1.0 + prnu * noise.normal(noise.pixel_bits(prnu_row, x0 + j)), 0.0)
            pixel_dark = dark
            if hot_share > 0.0 and dark > 0.0:
                bits = noise.pixel_bits(hot_row, x0 + j)
                if noise.uniform(bits) < hot_share:
                    pixel_dark *= np.exp(_HOT_LOG_LOW + _HOT_LOG_SPAN * noise.uniform(noise.mix(bits + noise.GOLDEN)))
            electrons[i, j] = noise.poisson(mean + pixel_dark, noise.pixel_bits(shot_row, x0 + j))


@kernel
def _digitise(electrons, dn, x0, y0, read_key, dsnu_key, read_noise, dsnu, K, rows, columns, white):
    height, width = electrons.shape
    for i in range(height):
        read_row = noise.line_key(read_key, y0 + i)
        dsnu_row = noise.line_key(dsnu_key, y0 + i)
        for j in range(width):
            charge = np.float64(electrons[i, j])
            if read_noise > 0.0:
                charge += read_noise * noise.normal(noise.pixel_bits(read_row, x0 + j))
            if dsnu > 0.0:
                charge += dsnu * noise.normal(noise.pixel_bits(dsnu_row, x0 + j))
            value = np.floor(charge * K + rows[i] + columns[j] + 0.5)
            dn[i, j] = min(max(value, 0.0), white)


@kernel
def _line_offsets(key, first, count):
    offsets = np.empty(count)
    for i in range(count):
        offsets[i] = noise.normal(noise.line_key(key, first + i))
    return offsets
