"""SceneSpec in, RenderedFrame out: one ray through every pixel, more where the picture has an edge."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Int

from proxnav.geometry import Camera
from proxnav.records import RenderedFrame, SceneSpec, Window
from proxnav.rendering.earth import background_image
from proxnav.rendering.raycast import pixels as grid
from proxnav.rendering.raycast.config import RaycastConfig
from proxnav.rendering.raycast.lights import light_up
from proxnav.rendering.raycast.model import Model, build_model
from proxnav.rendering.raycast.rays import projected_box
from proxnav.rendering.raycast.view import BATCH, Hits, RenderView, look, probe, probe_all, select, shade
from proxnav.targets import Target

_WIDEST_PENUMBRA_PX = 32
_LAMP_RAD = 0.02
"""Discs beyond this angular radius may soften shadows anywhere on the target."""


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

    def render(self, scene: SceneSpec, window: Window | None = None, camera: Camera | None = None) -> RenderedFrame:
        """The scene through its camera, or through `camera` at the same place, over `window` (default all of it)."""
        camera = camera or scene.camera
        window = window or Window(0, 0, camera.width, camera.height)
        foreground = self._foreground(scene, camera, window)
        background = background_image(scene, camera, window, hidden=foreground.coverage == 1.0)
        radiance = foreground.radiance + (1.0 - foreground.coverage[..., None]) * background
        return RenderedFrame(
            window, radiance.astype(np.float32), foreground.depth_m, foreground.part, foreground.coverage
        )

    def _finest_m(self, scene: SceneSpec, camera: Camera) -> float:
        """Width [m] on the target of the narrowest ray that may be cast."""
        mesh = self._model.mesh
        nearest = float(np.linalg.norm(scene.T_cam_target.inverse().t_m - mesh.centre)) - mesh.radius
        samples = max(self.config.samples, self.config.interior_samples)
        return max(nearest, 0.0) / np.sqrt(camera.fx * camera.fy * samples)

    def _foreground(self, scene: SceneSpec, camera: Camera, window: Window) -> RenderedFrame:
        """The target alone, on black, radiance multiplied by coverage."""
        model = self._model
        frame = _empty(window)
        textures = model.textures(scene.texture, self._finest_m(scene, camera))
        lights = light_up(scene, model, textures, self.config)
        view = look(model, textures, lights, camera, scene.T_cam_target, self.config.reflections)
        halo = 1 + _penumbra_px(view) if lights.has_sun else 1
        region = _region(model, scene, view, window, halo)
        if region is not None:
            _fill(frame, view, region, halo, self.config)
        return frame


def _empty(window: Window) -> RenderedFrame:
    shape = window.height, window.width
    return RenderedFrame(
        window, np.zeros((*shape, 3), np.float32), np.full(shape, np.inf, np.float32), np.full(shape, -1, np.int16),
        np.zeros(shape, np.float32),
    )  # fmt: skip


def _penumbra_px(view: RenderView) -> int:
    """How far from a shadow's edge its softness may reach, at most [px]."""
    mesh = view.model.mesh
    nearest = max(float(np.linalg.norm(view.eye - mesh.centre)) - mesh.radius, 0.1)
    widest = 1.0 + 3.0 * view.lights.sun_half_angle * mesh.radius / (nearest * view.pixel_rad)
    return int(min(widest, _WIDEST_PENUMBRA_PX))


def _region(model: Model, scene: SceneSpec, view: RenderView, window: Window, halo: int) -> Window | None:
    """The part of the window, widened by `halo`, that the target may cover; None when it covers nothing of it."""
    x0, y0 = window.x - halo, window.y - halo
    x1, y1 = window.x + window.width + halo, window.y + window.height + halo
    box = projected_box(model.mesh.vertices, scene.T_cam_target, view.lens)
    if box is not None:
        low_x, low_y, high_x, high_y = box
        x0, y0 = int(max(x0, np.floor(low_x))), int(max(y0, np.floor(low_y)))
        x1, y1 = int(min(x1, np.ceil(high_x))), int(min(y1, np.ceil(high_y)))
    return Window(x0, y0, x1 - x0, y1 - y0) if x1 > x0 and y1 > y0 else None


def _fill(frame: RenderedFrame, view: RenderView, region: Window, halo: int, config: RaycastConfig) -> None:
    """Traces the region and writes what lies in the frame's window."""
    pixels = grid.grid_pixels(region.x, region.y, region.width, region.height)
    hits = probe_all(view, pixels)
    refined = _refined(view, hits, region, halo)
    inside = _inside(pixels, frame.window)
    seen = select(hits, inside[hits.ray])
    at = _places(pixels[seen.ray], frame.window)
    frame.depth_m[at] = seen.depth
    frame.part[at] = view.model.mesh.part[seen.triangle]
    frame.coverage[at] = 1.0
    plain = ~refined[seen.ray]
    _write(frame, view, pixels[inside & refined], config.samples, config.sun_rays_per_sample)
    if config.interior_samples > 1:
        _write(frame, view, pixels[seen.ray[plain]], config.interior_samples, 0)
    else:
        _write_centres(frame, view, pixels, select(seen, plain))


def _inside(pixels: Int[np.ndarray, "n 2"], window: Window) -> Bool[np.ndarray, "n"]:
    x, y = pixels[:, 0] - window.x, pixels[:, 1] - window.y
    return (x >= 0) & (x < window.width) & (y >= 0) & (y < window.height)


def _places(pixels: Int[np.ndarray, "n 2"], window: Window) -> tuple[Int[np.ndarray, "n"], Int[np.ndarray, "n"]]:
    """(rows, columns) in the window's arrays."""
    return pixels[:, 1] - window.y, pixels[:, 0] - window.x


def _refined(view: RenderView, hits: Hits, region: Window, halo: int) -> Bool[np.ndarray, "n"]:
    """Pixels of the region that one ray does not describe."""
    mesh, shape = view.model.mesh, (region.height, region.width)
    marked = np.zeros(shape, bool)
    index = np.full(region.height * region.width, -1, np.int64)
    index[hits.ray] = np.arange(len(hits.ray))
    index = index.reshape(shape)
    grid.mark_edges(index, hits.triangle, hits.position, hits.depth, mesh.normals, mesh.part, view.pixel_rad, marked)
    half_angle = view.lights.sun_half_angle
    if view.lights.has_sun and half_angle > _LAMP_RAD:
        marked.ravel()[hits.ray] = True
    elif view.lights.has_sun:
        grid.mark_penumbra(index, hits.shadow, hits.blocker, hits.depth, view.pixel_rad, half_angle, halo - 1, marked)
    return marked.ravel()


def _write_centres(frame: RenderedFrame, view: RenderView, pixels: Int[np.ndarray, "n 2"], hits: Hits) -> None:
    """Writes the radiance of pixels that their centre ray describes."""
    for i in range(0, len(hits.ray), BATCH):
        batch = select(hits, np.arange(i, min(i + BATCH, len(hits.ray))))
        frame.radiance[_places(pixels[batch.ray], frame.window)] = shade(view, batch, 1)


def _write(
    frame: RenderedFrame, view: RenderView, pixels: Int[np.ndarray, "n 2"], samples: int, sun_steps: int
) -> None:
    """Writes radiance and coverage of pixels as the mean over several samples."""
    step = max(1, BATCH // samples)
    for i in range(0, len(pixels), step):
        chosen = pixels[i : i + step]
        hits = probe(view, chosen, grid.sample_places(chosen, samples), samples, sun_steps)
        at = _places(chosen, frame.window)
        light, met = np.zeros((len(chosen) * samples, 3)), np.zeros(len(chosen) * samples)
        light[hits.ray], met[hits.ray] = shade(view, hits, samples), 1.0
        frame.radiance[at] = light.reshape(-1, samples, 3).sum(axis=1) / samples
        frame.coverage[at] = met.reshape(-1, samples).sum(axis=1) / samples
