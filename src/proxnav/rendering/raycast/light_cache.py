"""Diffuse light from Earth and from neighbouring surfaces, kept at points of the mesh.

What each point sees in a fixed set of directions never changes, because the target is rigid: it is traced once. For one
frame the light is gathered over those links, as a progressive radiosity step without form factors (C. Goral et al.,
"Modeling the interaction of light between diffuse surfaces", SIGGRAPH 1984).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float32, Float64, Int, Int32

from proxnav.geometry.compiled.kernel import ray_kernel
from proxnav.rendering.raycast.environment import map_cell
from proxnav.rendering.raycast.mesh import POSITION, RenderMesh
from proxnav.rendering.raycast.tracing import Tracer

_INSIDE = 0.5
"""Share of directions that end on the inside of a surface, above which a point counts as buried."""
OFFSET_M = 1e-4
"""Rays leave a surface from this far above it."""


@dataclass(frozen=True, slots=True, eq=False)
class LightCache:
    """Links of every point: cells of the environment map, and other points, as rows of a sparse matrix."""

    rays: int
    sky_start: Int32[np.ndarray, "n_cache_plus_1"]
    sky_cell: Int32[np.ndarray, "n_sky"]
    point_start: Int32[np.ndarray, "n_cache_plus_1"]
    point: Int32[np.ndarray, "n_links"]
    usable: Float32[np.ndarray, "n_cache"]
    """1, or 0 for points buried inside the target."""


def build_cache(mesh: RenderMesh, tracer: Tracer, rays: int, rows: int) -> LightCache:
    """Traces what every point of the mesh's light cache sees."""
    n = len(mesh.cache_position)
    cell, point, inside = (np.empty((n, rays), np.int32) for _ in range(3))
    for begin in range(0, n, 8192):
        part = slice(begin, begin + 8192)
        directions = _hemisphere(mesh.cache_normal[part], rays)
        cell[part], point[part], inside[part] = _look(mesh, tracer, mesh.cache_position[part], directions, rows)
    sky, linked = cell >= 0, point >= 0
    usable = (inside.mean(axis=1) < _INSIDE).astype(np.float32)
    return LightCache(rays, _starts(sky), cell[sky], _starts(linked), point[linked], usable)


def _look(
    mesh: RenderMesh,
    tracer: Tracer,
    positions: Float[np.ndarray, "n 3"],
    directions: Float[np.ndarray, "n rays 3"],
    rows: int,
) -> tuple[Int[np.ndarray, "n rays"], Int[np.ndarray, "n rays"], Bool[np.ndarray, "n rays"]]:
    """Map cell or -1, cache point or -1, and whether the ray meets a surface from inside."""
    n, rays = directions.shape[:2]
    # the first steps skip what touches the point itself: the far side of a seam, or a face it lies on
    origins = positions[:, None] + 10.0 * OFFSET_M * directions
    flat = directions.reshape(-1, 3)
    starts = np.ascontiguousarray(origins.reshape(-1, 3), np.float32)
    triangle = tracer.first_hit(starts, np.ascontiguousarray(flat, np.float32)).reshape(n, rays)
    cell = np.where(triangle < 0, map_cell(flat, rows).reshape(n, rays), -1)
    facing = np.einsum("nkc,nkc->nk", mesh.normals[triangle], directions)
    nearest = _nearest_corner(mesh, triangle, origins, directions)
    front = (triangle >= 0) & (facing < 0.0)
    return cell, np.where(front, nearest, -1), (triangle >= 0) & (facing >= 0.0)


def _nearest_corner(
    mesh: RenderMesh,
    triangle: Int[np.ndarray, "n rays"],
    origins: Float[np.ndarray, "n rays 3"],
    directions: Float[np.ndarray, "n rays 3"],
) -> Int[np.ndarray, "n rays"]:
    """Cache point of the corner nearest to where each ray meets its triangle."""
    corners = mesh.corners[triangle, :, POSITION : POSITION + 3]
    normals = mesh.normals[triangle]
    height = np.einsum("nkc,nkc->nk", corners[:, :, 0] - origins, normals)
    slope = np.einsum("nkc,nkc->nk", directions, normals)
    hit = origins + (height / np.where(slope == 0.0, 1.0, slope))[..., None] * directions
    which = ((corners - hit[:, :, None]) ** 2).sum(axis=-1).argmin(axis=-1)
    return np.take_along_axis(mesh.cache[triangle], which[..., None], axis=-1)[..., 0]


def _hemisphere(normals: Float[np.ndarray, "n 3"], rays: int) -> Float[np.ndarray, "n rays 3"]:
    """Directions of equal weight under the cosine law: the same pattern about every normal, so that flat stays flat."""
    k = np.arange(rays) + 0.5
    r, phi = np.sqrt(k / rays), 2.0 * np.pi * (k * 0.6180339887498949)
    local = np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1.0 - r * r)], axis=-1)
    # T. Duff et al., "Building an orthonormal basis, revisited", JCGT 6(1), 2017
    x, y, z = normals.T
    sign = np.where(z >= 0.0, 1.0, -1.0)
    a = -1.0 / (sign + z)
    b = x * y * a
    first = np.stack([1.0 + sign * x * x * a, sign * b, -sign * x], axis=-1)
    second = np.stack([b, sign + y * y * a, -y], axis=-1)
    basis = np.stack([first, second, normals], axis=1)
    return np.einsum("kl,nlc->nkc", local, basis)


def _starts(mask: Bool[np.ndarray, "n rays"]) -> Int32[np.ndarray, "n_plus_1"]:
    return np.concatenate([[0], np.cumsum(mask.sum(axis=1))]).astype(np.int32)


@ray_kernel
def gather_sky(start, cell, rays, radiance, irradiance):
    """Adds the irradiance from the cells of the environment map (cells, 3) that each point sees."""
    scale = np.pi / rays
    for i in range(irradiance.shape[0]):
        r, g, b = 0.0, 0.0, 0.0
        for k in range(start[i], start[i + 1]):
            j = cell[k]
            r += radiance[j, 0]
            g += radiance[j, 1]
            b += radiance[j, 2]
        irradiance[i, 0] += scale * r
        irradiance[i, 1] += scale * g
        irradiance[i, 2] += scale * b


@ray_kernel
def gather_surfaces(start, point, rays, exitance, irradiance):
    """Adds the irradiance from the points that each point sees, which send out `exitance` [W/m^2] evenly."""
    for i in range(irradiance.shape[0]):
        r, g, b = 0.0, 0.0, 0.0
        for k in range(start[i], start[i + 1]):
            j = point[k]
            r += exitance[j, 0]
            g += exitance[j, 1]
            b += exitance[j, 2]
        irradiance[i, 0] += r / rays
        irradiance[i, 1] += g / rays
        irradiance[i, 2] += b / rays


def gather(
    cache: LightCache,
    albedo: Float[np.ndarray, "n_cache 3"],
    emitted: Float[np.ndarray, "n_cache 3"],
    sunlight: Float[np.ndarray, "n_cache 3"],
    sky: Float32[np.ndarray, "rows columns 3"] | None,
    bounces: int,
) -> Float64[np.ndarray, "n_cache 3"]:
    """Indirect irradiance [W/m^2] of every point under direct sunlight, emission and Earth's map."""
    from_sky = np.zeros_like(sunlight)
    if sky is not None:
        gather_sky(cache.sky_start, cache.sky_cell, cache.rays, sky.reshape(-1, 3), from_sky)
    indirect = from_sky
    for _ in range(bounces):
        exitance = emitted + albedo * (sunlight + indirect)
        indirect = from_sky.copy()
        gather_surfaces(cache.point_start, cache.point, cache.rays, exitance, indirect)
    return indirect
