"""The image sensor and its optics as plain data: what is fixed by the camera, and what one exposure sets."""

from dataclasses import dataclass


@dataclass(frozen=True)
class SensorSpec:
    """A camera of the EMVA 1288 linear model; every effect is off when its number is zero."""

    name: str = "ideal"
    serial: int = 0
    """Seeds the fixed-pattern maps: the same serial is the same camera."""
    pixel_pitch_m: float = 5.86e-6
    f_number: float = 4.0
    transmission: float = 0.85
    """Of the optics."""
    quantum_efficiency: tuple[float, float, float] = (0.65, 0.65, 0.65)
    """In the bands 600-700, 500-600 and 400-500 nm."""
    colour: bool = False
    """Bayer mosaic (RGGB) instead of a monochrome sensor."""
    full_well_e: float = 32_500.0
    read_noise_e: float = 0.0
    dark_current_e_per_s: float = 0.0
    """At `dark_reference_c`."""
    dark_reference_c: float = 25.0
    dark_doubling_c: float = 7.0
    dsnu_e: float = 0.0
    prnu: float = 0.0
    """Standard deviation of the pixels' relative response."""
    hot_pixel_share: float = 0.0
    row_noise_dn: float = 0.0
    column_noise_dn: float = 0.0
    bits: int = 8
    gain_e_per_dn: float = 0.0
    """1/K; 0 means that the full well fills the range of the converter."""
    black_level_dn: float = 0.0
    psf_sigma_px: float = 0.0
    focus_m: float = 0.0
    """Focus distance; 0 is no defocus."""
    cos4: bool = False
    """Vignetting by cos^4 of the field angle."""
    veiling_glare: float = 0.0
    """Share of the frame's mean flux that is spread evenly over it."""
    flare: bool = False
    """Ghosts and starburst of the Sun in or near the field."""
    blooming: float = 0.0
    """Share of the charge above full well that spills to the neighbours."""
    particle_rate_cm2_s: float = 0.0
    """Charged particles: a few per cm^2 and s in quiet low orbit, 100 to 1000 in the South Atlantic Anomaly."""


@dataclass(frozen=True)
class ExposureSpec:
    """One exposure: how long, how warm, how the scene moves meanwhile, and the seed of its temporal noise."""

    exposure_s: float = 0.0
    """0 asks the sensor to choose by its auto exposure."""
    temperature_c: float = 20.0
    v_cam_target_mps: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Velocity of the target in the camera frame."""
    omega_cam_radps: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Inertial rate of the camera, in its own axes."""
    seed: int = 0
