"""Training crops drawn on line: each is a fresh scene, ray-cast only inside the crop, read by a sensor.

A crop smaller than the network's input is drawn at the sensor's resolution; a larger one by a sensor whose pixels are
binned, because the network sees the mean of them anyway.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from jaxtyping import Bool

from proxnav.detection.samples import TrainingSample
from proxnav.geometry import Camera
from proxnav.geometry.boxes import box_of_mask, box_of_points, cut_at_edges
from proxnav.geometry.types import Box
from proxnav.images.crop import Crop, resample
from proxnav.images.tones import as_8_bit
from proxnav.missions import Mission
from proxnav.missions.views import accepted_views
from proxnav.records import NOT_IN_IMAGE, SceneSpec, SensorSpec, TextureSpec, Window
from proxnav.rendering.raycast import RaycastRenderer
from proxnav.rendering.raycast.config import QUICK
from proxnav.scenes.plain import BEHIND_M
from proxnav.scenes.random_scene import random_scene
from proxnav.sensor.expose import expose
from proxnav.sensor.presets import draw_sensor
from proxnav.targets import Target
from proxnav.targets.keypoints.visibility import visible_keypoints
from proxnav.targets.loading import load_target

_MARGINS = (1.05, 1.6)
"""Side of the crop over the longer side of the box, uniform in between: the finder is not exact."""
_SHIFT = 0.12
"""Most offset of the crop's centre over the longer side of the box."""
_ALIKE = 12
"""Neighbouring samples that share the target's textures: painting them costs more than drawing a crop."""


@dataclass(frozen=True)
class CropConfig:
    """Which crops of which scenes."""

    mission: Mission
    side: int = 128
    """Pixels of the network's input."""
    seed: int = 1


@dataclass(frozen=True)
class CropJob:
    """Builds, once per process, the function from a sample's number to the sample. Can be pickled."""

    config: CropConfig

    def __call__(self) -> Callable[[int], TrainingSample]:
        config, target = self.config, load_target(self.config.mission.target)
        renderer = RaycastRenderer(target, QUICK)

        def make(index: int) -> TrainingSample:
            scene = _scene(index, config)
            rng = np.random.default_rng([config.seed, index, 1])
            pixels = scene.camera.project(scene.T_cam_target @ target.vertices_m)
            box = cut_at_edges(box_of_points(pixels), scene.camera)
            return _draw(scene, _jittered(box, rng), config.side, target, renderer)

        return make


@dataclass(frozen=True)
class WholeFrameJob:
    """As `CropJob`, for the finder: whole frames at the finder's side, a share of them without a target."""

    config: CropConfig
    empty_share: float = 0.1

    def __call__(self) -> Callable[[int], TrainingSample]:
        config, target = self.config, load_target(self.config.mission.target)
        renderer = RaycastRenderer(target, QUICK)

        def make(index: int) -> TrainingSample:
            scene = _scene(index, config)
            if np.random.default_rng([config.seed, index, 2]).random() < self.empty_share:
                scene = replace(scene, t_cam_target_m=BEHIND_M)
            crop = Crop(0, 0, max(config.mission.camera.width, config.mission.camera.height))
            return _draw(scene, crop, config.side, target, renderer)

        return make


@dataclass(frozen=True)
class MixedJob:
    """For a detector that sees whole frames but learns faster from close views: crops and whole frames in turn."""

    crops: CropConfig
    frame_side: int

    def __call__(self) -> Callable[[int], TrainingSample]:
        near, whole = CropJob(self.crops)(), WholeFrameJob(replace(self.crops, side=self.frame_side))()
        return lambda index: near(index) if index % 2 else whole(index)


def _scene(index: int, config: CropConfig) -> SceneSpec:
    """Scene `index`, read by a camera of its own, in the textures of its group."""
    mission, draw = config.mission, partial(draw_sensor, base=config.mission.sensor)
    accept = accepted_views(mission, mission.camera)
    scene = random_scene(index, config.seed, mission.scenes, mission.target, mission.camera, draw, accept)
    rng = np.random.default_rng([config.seed, index // _ALIKE, 3])
    texture = TextureSpec(rng.uniform(*mission.looks.textures), int(rng.integers(2**31)))
    return replace(scene, texture=texture)


def _jittered(box: Box, rng: np.random.Generator) -> Crop:
    longer = max(box[2] - box[0], box[3] - box[1])
    shift = _SHIFT * longer * rng.uniform(-1.0, 1.0, size=2)
    return Crop.around(box + np.tile(shift, 2), margin=rng.uniform(*_MARGINS))


def _draw(scene: SceneSpec, crop: Crop, side: int, target: Target, renderer: RaycastRenderer) -> TrainingSample:
    binning = max(1, round(crop.size / side))
    pixels = -(-crop.size // binning)
    crop = Crop(crop.x, crop.y, pixels * binning)
    camera = scene.camera.cropped(crop.x, crop.y, crop.size, crop.size).resized(pixels, pixels)
    frame = renderer.render(scene, Window(0, 0, pixels, pixels), camera)
    binned_scene = replace(scene, camera=camera, sensor=binned(scene.sensor, binning))
    image = expose(frame, binned_scene).image
    inside = _inside_image(crop, scene.camera, pixels)
    mask = frame.mask & inside
    keypoints = scene.camera.project(scene.T_cam_target @ target.keypoints_m)
    shown = np.where(visible_keypoints(target, scene.T_cam_target), 2, 1)
    return TrainingSample(
        image=resample(np.where(inside, as_8_bit(image, scene.sensor.bits), np.uint8(0)), side),
        keypoints_px=crop.to_network(keypoints, side),
        visibility=np.where(scene.camera.contains(keypoints), shown, NOT_IN_IMAGE),
        box_xyxy=box_of_mask(mask) * (side / pixels),
        mask=resample(mask.astype(np.uint8) * 255, side) > 127,
    )


def binned(spec: SensorSpec, factor: int) -> SensorSpec:
    """The sensor whose pixels are means of `factor` x `factor` pixels of `spec`."""
    area = factor * factor
    return replace(
        spec,
        pixel_pitch_m=spec.pixel_pitch_m * factor,
        full_well_e=spec.full_well_e * area,
        gain_e_per_dn=spec.gain_e_per_dn * area,
        read_noise_e=spec.read_noise_e * factor,
        dark_current_e_per_s=spec.dark_current_e_per_s * area,
        dsnu_e=spec.dsnu_e * factor,
        prnu=spec.prnu / factor,
        psf_sigma_px=spec.psf_sigma_px / factor,
    )


def _inside_image(crop: Crop, camera: Camera, pixels: int) -> Bool[np.ndarray, "pixels pixels"]:
    """Where the crop lies in the image."""
    centre = (np.arange(pixels) + 0.5) * (crop.size / pixels)
    x, y = centre + crop.x, centre + crop.y
    return ((y >= 0) & (y < camera.height))[:, None] & ((x >= 0) & (x < camera.width))[None, :]
