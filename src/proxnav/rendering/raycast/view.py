"""One camera looking at one lit target: rays in, radiance and geometry out, in batches of fixed size."""

from dataclasses import dataclass, fields, replace

import numpy as np
from jaxtyping import Bool, Float, Float32, Int, Int8

from proxnav.geometry import Camera, Pose
from proxnav.geometry.compiled.lens import FX, FY, lens_numbers
from proxnav.rendering.raycast import pixels as grid
from proxnav.rendering.raycast import shading
from proxnav.rendering.raycast.bsdf import lobe_albedo_table
from proxnav.rendering.raycast.lights import Lights
from proxnav.rendering.raycast.model import Model
from proxnav.rendering.raycast.rays import cast
from proxnav.rendering.raycast.surface import COLUMNS, MIRROR, describe, locate
from proxnav.rendering.raycast.texels import TexelTable

BATCH = 32768
"""Rays at a time: small enough for the processor's cache, the same on every machine."""


@dataclass(frozen=True, slots=True, eq=False)
class Hits:
    """The rays that met the target: where, and how much of the Sun is seen from there."""

    ray: Int[np.ndarray, "n"]
    """Index among the rays that were cast."""
    triangle: Int[np.ndarray, "n"]
    position: Float[np.ndarray, "n 3"]
    depth: Float[np.ndarray, "n"]
    """z in the camera frame [m]."""
    weights: Float[np.ndarray, "n 3"]
    """Barycentric coordinates."""
    lit: Float[np.ndarray, "n"]
    """Share of the Sun's disc."""
    shadow: Int[np.ndarray, "n"]
    """1 where the Sun's ray arrives, 0 where something blocks it, -1 where the surface turns away."""
    blocker: Float32[np.ndarray, "n"]
    """Distance to what blocks the Sun [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class RenderView:
    """Camera, target and light of one frame."""

    model: Model
    textures: TexelTable
    lights: Lights
    lens: Float[np.ndarray, "lens=18"]
    """The camera as `lens_numbers` gives it."""
    R_target_cam: Float[np.ndarray, "3 3"]
    eye: Float[np.ndarray, "3"]
    """The camera's projection centre in the target frame [m]."""
    reflections: bool

    @property
    def pixel_rad(self) -> float:
        """Angle that a pixel near the optical axis spans."""
        return float(1.0 / np.sqrt(self.lens[FX] * self.lens[FY]))


def look(
    model: Model, textures: TexelTable, lights: Lights, camera: Camera, T_cam_target: Pose, reflections: bool
) -> RenderView:
    """The view of a camera."""
    T_target_cam = T_cam_target.inverse()
    return RenderView(model, textures, lights, lens_numbers(camera), T_target_cam.R, T_target_cam.t_m, reflections)


def probe(
    view: RenderView, pixels: Int[np.ndarray, "n 2"], places: Float[np.ndarray, "m 2"], per_pixel: int, sun_steps: int
) -> Hits:
    """What rays through `places` [px], `per_pixel` for each pixel, meet; `sun_steps` 0 aims at the Sun's centre."""
    rays, origins, directions = _rays(view, places)
    triangle = view.model.tracer.first_hit(origins, directions)
    ray = np.flatnonzero(triangle >= 0)
    n, triangle = len(ray), triangle[ray]
    position, depth, weights = np.empty((n, 3)), np.empty(n), np.empty((n, 3))
    camera_z = np.ascontiguousarray(view.R_target_cam[:, 2])
    locate(triangle, rays[ray], view.eye, camera_z, view.model.mesh.corners, position, depth, weights)
    sunlit = _sunlit(view, triangle, position, pixels, ray, per_pixel, sun_steps)
    return Hits(ray, triangle, position, depth, weights, *sunlit)


def probe_all(view: RenderView, pixels: Int[np.ndarray, "n 2"]) -> Hits:
    """What the rays through the centres of any number of pixels meet."""
    parts = []
    for begin in range(0, len(pixels), BATCH):
        batch = pixels[begin : begin + BATCH]
        hits = probe(view, batch, batch + 0.5, 1, 0)
        parts.append(replace(hits, ray=hits.ray + begin))
    return Hits(*(np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(Hits)))


def select(hits: Hits, chosen: Int[np.ndarray, "chosen"] | Bool[np.ndarray, "n"]) -> Hits:
    """Some of the hits, by index or flag."""
    return Hits(*(getattr(hits, f.name)[chosen] for f in fields(Hits)))


def shade(view: RenderView, hits: Hits, per_pixel: int) -> Float[np.ndarray, "n 3"]:
    """Radiance of the hits towards the eye, each standing for one part in `per_pixel` of its pixel."""
    mesh, lights = view.model.mesh, view.lights
    surface = _surface(view, hits, view.pixel_rad / np.sqrt(per_pixel))
    radiance = np.zeros((len(hits.triangle), 3))
    shading.shade_emission(hits.triangle, mesh.part, view.textures.parts, radiance)
    if lights.has_sun:
        shading.shade_sun(surface, lights.sun, hits.lit, lights.sun_irradiance, lights.sun_widening, radiance)
    if lights.has_ambient:
        _shade_ambient(view, hits, surface, radiance)
    return radiance


def _rays(
    view: RenderView, places: Float[np.ndarray, "m 2"]
) -> tuple[Float[np.ndarray, "m 3"], Float32[np.ndarray, "m 3"], Float32[np.ndarray, "m 3"]]:
    """Rays whose z in the camera is 1, in target axes, and where and along what Embree follows them."""
    n = len(places)
    rays, origins, directions = np.empty((n, 3)), np.empty((n, 3), np.float32), np.empty((n, 3), np.float32)
    mesh = view.model.mesh
    cast(places, view.lens, view.R_target_cam, view.eye, mesh.centre, mesh.radius, rays, origins, directions)
    return rays, origins, directions


def _sunlit(
    view: RenderView,
    triangle: Int[np.ndarray, "n"],
    position: Float[np.ndarray, "n 3"],
    pixels: Int[np.ndarray, "n_pixels 2"],
    ray: Int[np.ndarray, "n"],
    per_pixel: int,
    steps: int,
) -> tuple[Float[np.ndarray, "n"], Int8[np.ndarray, "n"], Float32[np.ndarray, "n"]]:
    """(share of the Sun's disc, `Hits.shadow`, distance to the blocker) of each hit."""
    n = len(triangle)
    lit, shadow, blocker = np.zeros(n), np.full(n, -1, np.int8), np.zeros(n, np.float32)
    if not view.lights.has_sun:
        return lit, shadow, blocker
    which, origins, directions = np.empty(n, np.int64), np.empty((n, 3), np.float32), np.empty((n, 3), np.float32)
    normals = view.model.mesh.normals
    for step in range(max(1, steps)):
        sun = _sun_directions(view, pixels, ray, per_pixel, step, steps)
        count = shading.sun_rays(triangle, position, view.eye, normals, sun, which, origins, directions)
        index = which[:count]
        distance = view.model.tracer.distance(origins[:count], directions[:count])
        free = np.isinf(distance)
        lit[index] += free / max(1, steps)
        shadow[index] = free
        blocker[index] = np.where(free, 0.0, distance)
    return lit, shadow, blocker


def _sun_directions(
    view: RenderView,
    pixels: Int[np.ndarray, "n_pixels 2"],
    ray: Int[np.ndarray, "n"],
    per_pixel: int,
    step: int,
    steps: int,
) -> Float[np.ndarray, "n 3"]:
    """Direction to a point of the Sun's disc for each ray, target axes."""
    if steps == 0:
        return np.broadcast_to(view.lights.sun, (len(ray), 3))
    directions = np.empty((len(pixels) * per_pixel, 3))
    grid.sun_points(pixels, per_pixel, step, steps, view.lights.sun, view.lights.sun_half_angle, directions)
    return directions[ray]


def _surface(view: RenderView, hits: Hits, pixel_rad: float) -> Float[np.ndarray, "n columns"]:
    """Description of the surface at each hit, its places as `surface` names them."""
    mesh, textures = view.model.mesh, view.textures
    surface = np.empty((len(hits.triangle), COLUMNS))
    describe(
        hits.triangle, hits.position, hits.weights, view.eye, pixel_rad, mesh.corners, mesh.normals, mesh.tangents,
        mesh.part, textures.texels, textures.levels, textures.parts, surface,
    )  # fmt: skip
    if not view.reflections:
        surface[:, MIRROR] = 0.0
    return surface


def _shade_ambient(
    view: RenderView, hits: Hits, surface: Float[np.ndarray, "n columns"], radiance: Float[np.ndarray, "n band=3"]
) -> None:
    """Adds the light cache's diffuse light and what the mirror rays see."""
    mesh, lights, table = view.model.mesh, view.lights, lobe_albedo_table()
    usable = view.model.cache.usable
    shading.shade_ambient(hits.triangle, hits.weights, surface, mesh.cache, usable, lights.indirect, table, radiance)
    n = len(hits.triangle)
    which, origins, directions = np.empty(n, np.int64), np.empty((n, 3), np.float32), np.empty((n, 3), np.float32)
    count = shading.mirror_rays(hits.position, surface, which, origins, directions)
    seen = view.model.tracer.first_hit(origins[:count], directions[:count])
    shading.shade_mirror(
        which[:count], directions, seen, origins, mesh.corners, mesh.cache, mesh.part, view.textures.parts,
        view.textures.means, usable, lights.indirect, lights.sun_seen, lights.sun, lights.sun_irradiance, surface,
        lights.environment.radiance, lights.environment.lobes, table, radiance,
    )  # fmt: skip
