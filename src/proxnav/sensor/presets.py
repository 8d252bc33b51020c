"""Cameras by name, drawn at random about them, and made noisier for robustness tables."""

from dataclasses import dataclass, replace

import numpy as np

from proxnav.errors import InputError, did_you_mean
from proxnav.records import SensorSpec

IDEAL = SensorSpec(bits=12)
"""No noise but that of the photons, no blur; 12 bit."""

SPEED_CLASS = SensorSpec(
    name="speed-class",
    pixel_pitch_m=5.86e-6,  # data sheet of the Sony IMX174/249, confirmed by SPEED's camera.json
    f_number=4.0,
    transmission=0.85,
    quantum_efficiency=(0.60, 0.74, 0.62),  # 0.70-0.76 at 525 nm, unverified; red and blue by the usual curve
    full_well_e=32_500.0,  # unverified
    read_noise_e=7.0,  # unverified
    dark_current_e_per_s=5.0,  # "a few", unverified
    prnu=0.008,  # 0.5-1 %, unverified
    dsnu_e=2.0,  # 1-3 e-, unverified
    hot_pixel_share=2e-5,
    row_noise_dn=0.3,
    column_noise_dn=0.3,
    bits=8,
    black_level_dn=2.0,
    psf_sigma_px=0.6,  # diffraction at f/4 is 0.2 px; lenses and focus make it 0.4-1.0
    cos4=True,
    veiling_glare=0.004,  # 0.1-1 %
    flare=True,
    blooming=0.05,
    particle_rate_cm2_s=3.0,  # quiet low orbit, unverified
    readout_s=0.02,
    halo=0.01,
)
"""The class of camera behind SPEED and SPEED+ (Sony IMX174/249, global shutter), mono, 8 bit, f/4."""

CMV4000_CLASS = replace(
    SPEED_CLASS,
    name="cmv4000-class",
    pixel_pitch_m=5.5e-6,  # unverified
    quantum_efficiency=(0.50, 0.60, 0.45),  # 0.6 peak, unverified
    full_well_e=13_500.0,  # unverified
    read_noise_e=13.0,  # unverified
    dark_current_e_per_s=125.0,  # at 25 C, unverified
    dsnu_e=4.0,
    row_noise_dn=0.6,
    column_noise_dn=0.8,
    bits=10,
    black_level_dn=16.0,
)
"""The class of many CubeSat cameras (2048 x 2048, global shutter), mono, 10 bit, f/4."""

SPEEDPLUS_CLASS = replace(
    SPEED_CLASS,
    name="speedplus-class",
    f_number=2.8,  # with the focus below: edges blur from 0.7 px at 2.7 m to 1.4 px beyond 5 m, as measured
    focus_m=2.7,
    psf_sigma_px=0.7,
    full_well_e=4460.0,  # 20 electrons for each DN: at least 18 measured in the median photograph, JPEG
    gain_e_per_dn=20.0,  # well and black level together reach 255: saturated faces keep their noise
    read_noise_e=138.0,  # 6.9 DN
    black_level_dn=32.0,  # 28 to 37 from photograph to photograph
    row_noise_dn=0.0,
    column_noise_dn=0.0,
    particle_rate_cm2_s=0.0,
    flare=False,  # no sun in a laboratory
    exposure_bias=1.8,  # so that the craft saturates as often as in the photographs
)
"""What the photographs of SPEED+ (lightbox, JPEG) look like: tools/measure_photographs.py prints the numbers."""

SENSORS = {
    sensor.name: sensor
    for sensor in (
        IDEAL,
        SPEED_CLASS,
        CMV4000_CLASS,
        SPEEDPLUS_CLASS,
        replace(SPEED_CLASS, name="speed-class-colour", colour=True, quantum_efficiency=(0.48, 0.60, 0.50)),
        replace(CMV4000_CLASS, name="cmv4000-class-colour", colour=True, quantum_efficiency=(0.40, 0.48, 0.36)),
    )
}
"""All presets by name."""


def sensor_by_name(name: str) -> SensorSpec:
    """The preset of that name; InputError lists the names when there is none.

    >>> sensor_by_name("speed-class").full_well_e
    32500.0
    """
    if name not in SENSORS:
        raise InputError(f"no sensor '{name}', choose one of {', '.join(SENSORS)}{did_you_mean(name, SENSORS)}")
    return SENSORS[name]


@dataclass(frozen=True, slots=True)
class SensorRanges:
    """Limits (low, high) within which a random camera lies; the defaults are what real parts span."""

    quantum_efficiency: tuple[float, float] = (0.4, 0.75)
    """Quantum efficiency of the green band; the others keep the base's ratio to it."""
    full_well_e: tuple[float, float] = (5e3, 40e3)
    read_noise_e: tuple[float, float] = (2.0, 20.0)
    dark_current_e_per_s: tuple[float, float] = (1.0, 1000.0)
    dsnu_e: tuple[float, float] = (0.5, 10.0)
    prnu: tuple[float, float] = (0.003, 0.02)
    hot_pixel_share: tuple[float, float] = (1e-5, 1e-4)
    dead_pixel_share: tuple[float, float] = (1e-6, 3e-5)
    line_noise_dn: tuple[float, float] = (0.3, 1.0)
    """Noise of rows and of columns, for 8 bit; scaled to the base's bits."""
    psf_sigma_px: tuple[float, float] = (0.4, 1.0)
    veiling_glare: tuple[float, float] = (0.001, 0.01)
    halo: tuple[float, float] = (0.002, 0.03)
    blooming: tuple[float, float] = (0.01, 0.2)
    particle_rate_cm2_s: tuple[float, float] = (1.0, 500.0)
    aperture_blades: tuple[int, int] = (5, 9)
    black_level_dn: tuple[float, float] | None = None
    """The base's own where None, and so is the next."""
    exposure_bias: tuple[float, float] | None = None


OWN_RANGES = {
    SPEEDPLUS_CLASS.name: SensorRanges(
        full_well_e=(3000.0, 8000.0),
        read_noise_e=(40.0, 180.0),
        psf_sigma_px=(0.4, 1.6),
        black_level_dn=(2.0, 45.0),
        exposure_bias=(0.5, 6.0),
        particle_rate_cm2_s=(0.0, 0.0),
    )
}
"""Limits of random cameras whose base is so unlike others that the default limits would not hold it."""


def draw_sensor(rng: np.random.Generator, base: SensorSpec, ranges: SensorRanges | None = None) -> SensorSpec:
    """A camera of its own serial within the ranges, log-uniform where a range spans more than a factor of two.

    Without `ranges` they are those of `OWN_RANGES` for the base, else the default. Format, lens, bits and colour stay
    those of the base, black level and exposure bias too where no range is given; the gain follows the full well.
    """
    ranges = ranges or OWN_RANGES.get(base.name, SensorRanges())
    drawn = {name: _draw(rng, *getattr(ranges, name)) for name in _DRAWN}
    factor = _draw(rng, *ranges.quantum_efficiency) / base.quantum_efficiency[1]
    red, green, blue = (min(value * factor, 0.95) for value in base.quantum_efficiency)
    line_unit = 2.0 ** (base.bits - 8)
    low, high = ranges.aperture_blades
    serial = int(rng.integers(2**31))
    drawn |= {name: _draw(rng, *limits) for name in _OPTIONAL if (limits := getattr(ranges, name)) is not None}
    return replace(
        base,
        **drawn,
        name=f"{base.name}-random",
        serial=serial,
        dead_pixel_share=_draw(np.random.default_rng(serial), *ranges.dead_pixel_share),
        quantum_efficiency=(red, green, blue),
        gain_e_per_dn=0.0,
        row_noise_dn=line_unit * _draw(rng, *ranges.line_noise_dn),
        column_noise_dn=line_unit * _draw(rng, *ranges.line_noise_dn),
        aperture_blades=int(rng.integers(low, high + 1)),
    )


_DRAWN = (
    "full_well_e",
    "read_noise_e",
    "dark_current_e_per_s",
    "dsnu_e",
    "prnu",
    "hot_pixel_share",
    "psf_sigma_px",
    "veiling_glare",
    "halo",
    "blooming",
    "particle_rate_cm2_s",
)
_OPTIONAL = ("black_level_dn", "exposure_bias")


def _draw(rng: np.random.Generator, low: float, high: float) -> float:
    if low > 0.0 and high > 2.0 * low:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))
    return float(rng.uniform(low, high))


def scaled_noise(sensor: SensorSpec, k: float) -> SensorSpec:
    """The same camera with k times the noise, for robustness tables; optics stay as they are.

    Read noise, fixed patterns and dark noise grow by k. Photon noise does so too: with 1/k^2 of the light collected in
    a well of 1/k^2 the size the picture is as bright, and its relative photon noise k times as large.
    """
    if not k > 0.0:
        raise InputError(f"the noise of a sensor can be scaled by a positive factor only, found {k}")
    red, green, blue = (value / k**2 for value in sensor.quantum_efficiency)
    return replace(
        sensor,
        name=f"{sensor.name}-x{k:g}",
        quantum_efficiency=(red, green, blue),
        full_well_e=sensor.full_well_e / k**2,
        gain_e_per_dn=sensor.gain_e_per_dn / k**2,
        read_noise_e=sensor.read_noise_e / k,
        dsnu_e=sensor.dsnu_e / k,
        dark_current_e_per_s=sensor.dark_current_e_per_s / k**2,
        prnu=sensor.prnu * k,
        row_noise_dn=sensor.row_noise_dn * k,
        column_noise_dn=sensor.column_noise_dn * k,
    )
