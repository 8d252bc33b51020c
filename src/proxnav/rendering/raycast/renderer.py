"""SceneSpec in, Frame out: one ray through every pixel, more where the picture has an edge."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float32

from proxnav.datasets.records import Frame, SceneSpec, Window
from proxnav.datasets.records.scene import SUN_HALF_ANGLE
from proxnav.geometry import Camera
from proxnav.rendering.earth import background_image
from proxnav.rendering.raycast import pixels as grid
from proxnav.rendering.raycast.config import RaycastConfig
from proxnav.rendering.raycast.lights import light_up
from proxnav.rendering.raycast.model import Model, build_model
from proxnav.rendering.raycast.rays import projected_box
from proxnav.rendering.raycast.view import BATCH, Samples, View, look, trace
from proxnav.targets import Target

_WIDEST_PENUMBRA_PX = 32


@dataclass(frozen=True)
class RaycastRenderer:
    """Renders frames of one target; building it costs a second, each frame milliseconds. Safe to share by threads."""

    target: Target
    config: RaycastConfig = field(default_factory=RaycastConfig)

    def __reduce__(self) -> tuple[type, tuple[Target, RaycastConfig]]:
        """Travels to other processes without its Embree scene, which is built again there."""
        return RaycastRenderer, (self.target, self.config)

    @cached_property
    def _model(self) -> Model:
        return build_model(self.target, self.config)

    def render(self, scene: SceneSpec, window: Window | None = None, camera: Camera | None = None) -> Frame:
        """The scene through its camera, or through `camera` at the same place, over `window` (default all of it)."""
        camera = camera or scene.camera
        window = window or Window(0, 0, camera.width, camera.height)
        foreground = self._foreground(scene, camera, window)
        background = background_image(scene, camera, window)
        radiance = foreground.radiance + (1.0 - foreground.coverage[..., None]) * background
        return Frame(window, radiance.astype(np.float32), foreground.depth_m, foreground.part, foreground.coverage)

    def _foreground(self, scene: SceneSpec, camera: Camera, window: Window) -> Frame:
        """The target alone, on black, radiance multiplied by coverage."""
        model = self._model
        frame = _empty(window)
        textures = model.textures(scene.texture)
        lights = light_up(scene, model, textures, self.config)
        view = look(model, textures, lights, camera, scene.T_cam_target, self.config.reflections)
        halo = 1 + _penumbra_px(view) if lights.has_sun else 1
        region = _region(model, scene, view, window, halo)
        if region is not None:
            _fill(frame, view, region, halo, self.config)
        return frame


def _empty(window: Window) -> Frame:
    shape = window.height, window.width
    return Frame(
        window, np.zeros((*shape, 3), np.float32), np.full(shape, np.inf, np.float32), np.full(shape, -1, np.int16),
        np.zeros(shape, np.float32),
    )  # fmt: skip


def _penumbra_px(view: View) -> int:
    """How far from a shadow's edge its softness may reach, at most [px]."""
    mesh = view.model.mesh
    nearest = max(float(np.linalg.norm(view.eye - mesh.centre)) - mesh.radius, 0.1)
    return int(min(1.0 + 3.0 * SUN_HALF_ANGLE * mesh.radius / (nearest * view.pixel_rad), _WIDEST_PENUMBRA_PX))


def _region(model: Model, scene: SceneSpec, view: View, window: Window, halo: int) -> Window | None:
    """The part of the window, widened by `halo`, that the target may cover; None when it covers nothing of it."""
    x0, y0 = window.x - halo, window.y - halo
    x1, y1 = window.x + window.width + halo, window.y + window.height + halo
    box = projected_box(model.mesh.vertices, scene.T_cam_target, view.camera)
    if box is not None:
        x0, y0 = int(max(x0, np.floor(box[0]))), int(max(y0, np.floor(box[1])))
        x1, y1 = int(min(x1, np.ceil(box[2]))), int(min(y1, np.ceil(box[3])))
    return Window(x0, y0, x1 - x0, y1 - y0) if x1 > x0 and y1 > y0 else None


def _fill(frame: Frame, view: View, region: Window, halo: int, config: RaycastConfig) -> None:
    """Traces the region and writes what lies in the frame's window."""
    pixels = grid.grid_pixels(region.x, region.y, region.width, region.height)
    base = _trace_centres(view, pixels)
    refined = _refined(view, base, region, halo)
    inside = _inside(pixels, frame.window)
    row, column = pixels[:, 1] - frame.window.y, pixels[:, 0] - frame.window.x
    plain = inside & (base.triangle >= 0)
    at = row[plain], column[plain]
    frame.depth_m[at] = base.depth[plain]
    frame.part[at] = view.model.mesh.part[base.triangle[plain]]
    frame.coverage[at] = 1.0
    frame.radiance[at] = base.radiance[plain]
    _write(frame, view, pixels[inside & refined], config.samples, config.sun_rays_per_sample)
    if config.interior_samples > 1:
        _write(frame, view, pixels[plain & ~refined], config.interior_samples, 0)


def _inside(pixels: np.ndarray, window: Window) -> np.ndarray:
    x, y = pixels[:, 0] - window.x, pixels[:, 1] - window.y
    return (x >= 0) & (x < window.width) & (y >= 0) & (y < window.height)


def _trace_centres(view: View, pixels: np.ndarray) -> Samples:
    """One sample at the centre of each pixel."""
    parts = [
        trace(view, pixels[i : i + BATCH], pixels[i : i + BATCH] + 0.5, 1, 0) for i in range(0, len(pixels), BATCH)
    ]
    names = ("triangle", "radiance", "position", "depth", "lit", "blocker")
    return Samples(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def _refined(view: View, base: Samples, region: Window, halo: int) -> Bool[np.ndarray, "n"]:
    """Pixels of the region that one ray does not describe."""
    shape = region.height, region.width
    mesh = view.model.mesh
    marked = np.zeros(shape, bool)
    triangle, depth = base.triangle.reshape(shape), base.depth.reshape(shape)
    position = base.position.reshape(*shape, 3)
    grid.mark_edges(triangle, position, depth, mesh.normals, mesh.part, view.pixel_rad, marked)
    if view.lights.has_sun:
        lit, blocker = base.lit.reshape(shape), base.blocker.reshape(shape)
        grid.mark_penumbra(lit, blocker, depth, view.pixel_rad, SUN_HALF_ANGLE, halo - 1, marked)
    return marked.ravel()


def _write(frame: Frame, view: View, pixels: np.ndarray, samples: int, sun_steps: int) -> None:
    """Replaces radiance and coverage of the given pixels by the mean over several samples."""
    step = max(1, BATCH // samples)
    for i in range(0, len(pixels), step):
        chosen = pixels[i : i + step]
        found = trace(view, chosen, grid.sample_places(chosen, samples), samples, sun_steps)
        at = chosen[:, 1] - frame.window.y, chosen[:, 0] - frame.window.x
        frame.radiance[at] = _mean(found.radiance, samples)
        frame.coverage[at] = _mean((found.triangle >= 0).astype(np.float32)[:, None], samples)[:, 0]


def _mean(values: Float32[np.ndarray, "n_times_samples c"], samples: int) -> Float32[np.ndarray, "n c"]:
    return values.reshape(-1, samples, values.shape[1]).mean(axis=1, dtype=np.float64).astype(np.float32)
