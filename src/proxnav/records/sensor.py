"""The image sensor and its optics as plain data: what is fixed by the camera, and what one exposure sets."""

from dataclasses import dataclass


@dataclass(frozen=True)
class SensorSpec:
    """A camera of the EMVA 1288 linear model; every effect is off when its number is zero.

    Lengths in px are pixels of this sensor. The numbers of an ideal camera are the defaults.
    """

    name: str = "ideal"
    """Name of the preset or the part; for people."""
    serial: int = 0
    """Seeds the fixed-pattern maps: the same serial is the same camera."""
    pixel_pitch_m: float = 5.86e-6
    """Side of the square pixel, filled to 100 %."""
    f_number: float = 4.0
    """Focal length over entrance pupil; the focal length itself is the camera's fx times the pitch."""
    transmission: float = 0.85
    """Transmission of the optics."""
    quantum_efficiency: tuple[float, float, float] = (0.65, 0.65, 0.65)
    """Electrons per photon in the bands 600-700, 500-600 and 400-500 nm, colour filters included."""
    colour: bool = False
    """Bayer mosaic (RGGB) instead of a monochrome sensor."""
    full_well_e: float = 32_500.0
    """Charge at which a pixel saturates [electrons]."""
    read_noise_e: float = 0.0
    """Standard deviation of one read-out [electrons], temporal."""
    dark_current_e_per_s: float = 0.0
    """Mean dark current of a pixel at `dark_reference_c`."""
    dark_reference_c: float = 25.0
    """Temperature [C] at which the dark current is stated."""
    dark_doubling_c: float = 7.0
    """The dark current doubles with so many kelvin."""
    dsnu_e: float = 0.0
    """Standard deviation of the pixels' fixed offsets [electrons]."""
    prnu: float = 0.0
    """Standard deviation of the pixels' relative response."""
    hot_pixel_share: float = 0.0
    """Share of pixels whose dark current is 100 to 100 000 times the mean (log-uniform)."""
    dead_pixel_share: float = 0.0
    """Share of pixels that do not answer to light."""
    row_noise_dn: float = 0.0
    """Standard deviation of the rows' fixed offsets [DN]."""
    column_noise_dn: float = 0.0
    """Standard deviation of the columns' fixed offsets [DN]."""
    bits: int = 8
    """Bits of the converter; up to 8 gives uint8 images, more gives uint16 with values below 2^bits."""
    gain_e_per_dn: float = 0.0
    """1/K; 0 means that the full well fills the range of the converter."""
    black_level_dn: float = 0.0
    """Offset [DN] that keeps the noise of black pixels above zero."""
    psf_sigma_px: float = 0.0
    """Standard deviation of the lens's Gaussian point-spread function."""
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
    readout_s: float = 0.0
    """Time after the exposure during which particles still leave tracks."""
    halo: float = 0.0
    """Share of the light that the lens spreads into a soft halo about bright things (optical bloom)."""
    sun_scatter: float = 0.01
    """Share of the Sun's light in the lens that scatters over the image; used when `flare` is on."""
    aperture_blades: int = 7
    """Straight edges of the iris, which make the starburst's spikes; 0 is a round aperture without spikes."""
    exposure_bias: float = 1.0
    """Factor on the exposure that is chosen for a single frame: above 1 bright faces saturate, as operators allow."""


@dataclass(frozen=True)
class ExposureSpec:
    """One exposure: how long, how warm, how the scene moves meanwhile, and the seed of its temporal noise."""

    exposure_s: float = 0.0
    """0 asks the sensor to choose by its auto exposure."""
    temperature_c: float = 20.0
    """Temperature of the detector [C]."""
    v_cam_target_mps: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Velocity of the target's origin as the camera sees it: the time derivative of t_cam_target, camera rate included.
    What is far away moves in the image by the camera's rate alone."""
    omega_cam_radps: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Inertial rate of the camera, in its own axes."""
    seed: int = 0
    """Seed of the temporal noise: another one is another exposure by the same camera."""
