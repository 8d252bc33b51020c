"""One exposure: what a renderer saw, as the camera's detector reads it."""

from dataclasses import dataclass

import numpy as np

from proxnav.geometry import Camera
from proxnav.records import RenderedFrame, SceneSpec
from proxnav.sensor import blur, colour, flare, glare
from proxnav.sensor.auto_exposure import choose_exposure
from proxnav.sensor.detector import Counts, gain_e_per_dn, read_out
from proxnav.sensor.layers import blur_layers, layer_kernels
from proxnav.sensor.photometry import cos4, electron_rate


@dataclass(frozen=True, slots=True, eq=False)
class Exposure:
    """The camera's raw image; its time stamp is mid-exposure."""

    image: Counts
    """Digital numbers; a Bayer mosaic when the sensor is a colour one."""
    exposure_s: float
    saturated_share: float
    """Share of the pixels at full well or at the end of the converter's range."""
    white_dn: int
    """The largest digital number, 2^bits - 1."""


def expose(
    frame: RenderedFrame, scene: SceneSpec, exposure_s: float | None = None, camera: Camera | None = None
) -> Exposure:
    """Read `frame` with the scene's sensor. Exposure: the argument, else the scene's, else chosen by the sensor.

    A frame that is a window of the image gives the same pixels as the window of the full frame's exposure, but for what
    blur and veil would have brought in from outside. `camera` is that of the frame where it is not the scene's (a
    crop rendered at another resolution): its window counts that camera's pixels, each of which is then read as one
    pixel of the sensor, with the same light, well and noise, while blur is scaled to what the real lens would give.
    """
    camera = camera or scene.camera
    exposure_s = exposure_s or scene.exposure.exposure_s or choose_exposure(frame, scene)
    signal = form_image(frame, scene, exposure_s, camera) * np.float32(exposure_s)
    if scene.sensor.colour:
        signal = colour.mosaic(signal, frame.window)
    size = (camera.width, camera.height)
    image = read_out(signal, scene.sensor, scene.exposure, exposure_s, frame.window, size)
    white_dn = 2**scene.sensor.bits - 1
    image.setflags(write=False)
    return Exposure(image, float(exposure_s), _saturated(image, scene, white_dn), white_dn)


def form_image(frame: RenderedFrame, scene: SceneSpec, exposure_s: float, camera: Camera) -> blur.Image:
    """Expected photo-electrons per second, in three bands for a colour sensor: the optics, in their order."""
    sensor = scene.sensor
    pixel_scale = camera.fx / scene.camera.fx
    rate = electron_rate(frame.radiance, sensor)
    if sensor.cos4:
        falloff = cos4(camera, frame.window)
        rate = rate * (falloff[..., None] if sensor.colour else falloff)
    rate = blur.gaussian(rate, sensor.psf_sigma_px * pixel_scale)
    kernels = layer_kernels(frame, sensor, scene.exposure, exposure_s, camera, pixel_scale)
    rate = blur_layers(rate, frame.coverage, kernels)
    if sensor.flare:
        rate = flare.add_flare(rate, frame, scene, camera)
    rate = glare.veil(rate, sensor.veiling_glare)
    return glare.halo(rate, sensor.halo, pixel_scale)


def _saturated(image: Counts, scene: SceneSpec, white_dn: int) -> float:
    sensor = scene.sensor
    well_dn = sensor.full_well_e / gain_e_per_dn(sensor) + sensor.black_level_dn
    # read noise and fixed offsets scatter a full pixel about its level: three of their deviations below counts as full
    spread = 3.0 * (sensor.read_noise_e + sensor.dsnu_e) / gain_e_per_dn(sensor)
    level = min(white_dn, round(well_dn - spread))
    return float((image >= level).mean())
