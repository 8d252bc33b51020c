"""What varies smoothly over the image: where a ray lands, and the light and air there, as one row of numbers.

The row is exact for one ray; between rays that land near each other it is interpolated, which is what makes a whole
image fast. Nothing finer than a few kilometres is in it: that is added by `detail`.
"""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Float32, UInt8

from proxnav.geometry.compiled.kernel import fast_inlined_kernel, fast_kernel
from proxnav.rendering.earth import clouds as cl
from proxnav.rendering.earth.aerial import BEHIND, CLOUD, CLOUD_TOP_M, GROUND, SCATTERED, SKY, look
from proxnav.rendering.earth.atmosphere import SUN_MU_MAX, SUN_MU_MIN, SUN_NODES, sun_transmittance
from proxnav.rendering.earth.clouds import Clouds
from proxnav.rendering.earth.ellipsoid import A_M, STRETCH, near_hit
from proxnav.rendering.earth.surface import fresnel_water, glint, wind_mps

# Columns of the row. Triples are red, green, blue and hold radiances [W/(m^2 sr)] at the eye, path losses included.
X, LON, LAT, CX = 0, 3, 4, 5
# Sunlit white Lambertian ground per cosine; lit by the sky; glint; air in front.
DIRECT, DIFFUSE, MIRROR, AIR = 8, 11, 14, 17
MIRROR_SKY, MU, SUN_EAST, SUN_NORTH = 20, 21, 22, 23
C_DIRECT, C_DIFFUSE, C_AIR = 24, 27, 30  # the first two and the air for a white cloud
C_TILT, C_SLANT, VALUE, HEAP, WARP, SLOPE = 33, 34, 35, 36, 37, 38
SHADOW, TOWARD, FOOTPRINT, NIGHT, CIRRUS, C_MU, COS_VIEW, SIZE = 39, 40, 43, 44, 47, 48, 49, 50

BEYOND, IN_AIR, ON_CLOUD, ON_GROUND = 0, 1, 2, 3
"""Where a ray ends: in space, in space through the air, on the cloud shell but not the ground, on the ground."""

_SLOPE_STEP_M = 8e3
AIRGLOW = np.array([5e-12, 8e-12, 1.5e-12])  # W/(m^3 sr): 200 to 300 rayleigh overhead, mostly the 557.7 nm line


class Eye(NamedTuple):
    """Where the ray starts and where the light comes from, in Earth-fixed axes."""

    origin: Float[np.ndarray, "3"]
    """Place in stretched space [m]."""
    sun: Float[np.ndarray, "3"]
    """Unit vector to the Sun."""
    sun_stretched: Float[np.ndarray, "3"]
    """Unit vector to the Sun in stretched space."""
    irradiance: Float[np.ndarray, "band=3"]
    """Irradiance of the Sun [W/m^2]."""
    moon: Float[np.ndarray, "3"]
    """Unit vector to the Moon."""
    moon_half_angle: float
    """Angular radius of the Moon [rad]; 0 is no Moon."""
    show_sun: bool
    atmosphere: bool
    city_lights: bool


class World(NamedTuple):
    """What stays the same from frame to frame, and the clouds of this one."""

    transmittance: Float32[np.ndarray, "r mu band=3"]
    multiple: Float32[np.ndarray, "h mu_sun band=3"]
    sky_irradiance: Float32[np.ndarray, "sun_nodes band=3"]
    ground: tuple[UInt8[np.ndarray, "_rows _columns channel=7"], ...]
    clouds: Clouds


@fast_kernel
def _sky_light(table, mu, k):
    x = min(SUN_NODES - 1.001, max(0.0, (mu - SUN_MU_MIN) / (SUN_MU_MAX - SUN_MU_MIN) * (SUN_NODES - 1)))
    j = int(x)
    return (1.0 - (x - j)) * table[j, k] + (x - j) * table[j + 1, k]


@fast_kernel
def _place(o, t, dx, dy, dz):
    """Unit normal where the stretched ray is after t."""
    x, y, z = o[0] + t * dx, o[1] + t * dy, (o[2] + t * dz) * STRETCH
    s = 1.0 / math.sqrt(x * x + y * y + z * z)
    return x * s, y * s, z * s


@fast_inlined_kernel
def _light(eye, world, height_m, mu_sun, st, direct, diffuse):
    """Sun and sky on a white surface at a height, times the path's transmittance, which st[direct:] holds on entry."""
    s = (1.0, 1.0, 1.0)
    if eye.atmosphere:
        s = sun_transmittance(world.transmittance, A_M + height_m, mu_sun)
    for k in range(3):
        scale = st[direct + k] * eye.irradiance[k] / math.pi
        st[direct + k] = scale * s[k]
        st[diffuse + k] = scale * _sky_light(world.sky_irradiance, mu_sun, k) if eye.atmosphere else 0.0


@fast_kernel
def _airglow_path(radius, down, passes):
    """Length [m] of a ray inside the glowing layer, 87 to 97 km high; `passes` is 1 if it ends on Earth, else 2."""
    if radius < A_M + 97e3 or down <= 0.0:
        return 0.0
    low2 = radius * radius * (1.0 - down * down)
    outer, inner = (A_M + 97e3) ** 2 - low2, (A_M + 87e3) ** 2 - low2
    return passes * (math.sqrt(max(0.0, outer)) - math.sqrt(max(0.0, inner)))


@fast_inlined_kernel
def _air(eye, world, aerial, kind, down, cos_azimuth, nu, st, work, direct, air):
    """Air in front into st[air:], transmittance of the path into st[direct:]."""
    if not eye.atmosphere:
        for k in range(3):
            st[direct + k], st[air + k] = 1.0, 0.0
        return
    look(aerial, world.transmittance, world.multiple, kind, down, cos_azimuth, nu, work)
    for k in range(3):
        st[direct + k], st[air + k] = work[BEHIND + k], work[SCATTERED + k] * eye.irradiance[k]
    glow = _airglow_path(aerial.radius, down, 2.0 if kind == SKY else 1.0)
    for k in range(3):
        st[air + k] += AIRGLOW[k] * glow


@fast_kernel
def ray_state(eye, world, aerial, work, dx, dy, dz, pixel_rad, st):
    """Fills the row `st` for the true unit ray (dx, dy, dz) in Earth-fixed axes; returns where the ray ends."""
    s = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz * STRETCH * STRETCH)
    ux, uy, uz = dx * s, dy * s, dz * STRETCH * s
    o, to = eye.origin, eye.sun
    half_b = o[0] * ux + o[1] * uy + o[2] * uz
    down = -half_b / aerial.radius
    t_ground = near_hit(1.0, half_b, A_M, aerial.radius)
    t_cloud = near_hit(1.0, half_b, A_M + CLOUD_TOP_M, aerial.radius)
    if t_ground <= 0.0 and t_cloud <= 0.0 and down <= aerial.bounds[SKY, 1]:
        return BEYOND
    nu = dx * to[0] + dy * to[1] + dz * to[2]
    flat = eye.sun_stretched
    sines = math.sqrt(max(1e-18, (1.0 - down * down) * (1.0 - aerial.mu_sun * aerial.mu_sun)))
    cos_azimuth = (ux * flat[0] + uy * flat[1] + uz * flat[2] + down * aerial.mu_sun) / sines
    kind = GROUND if t_ground > 0.0 else SKY
    _air(eye, world, aerial, kind, down, cos_azimuth, nu, st, work, DIRECT, AIR)
    if t_ground > 0.0:
        _ground_state(eye, world, t_ground, ux, uy, uz, dx, dy, dz, nu, pixel_rad, st)
    has_cloud = t_cloud > 0.0 and world.clouds.threshold < cl.NONE
    if has_cloud:
        _air(eye, world, aerial, CLOUD, down, cos_azimuth, nu, st, work, C_DIRECT, C_AIR)
        _cloud_state(eye, world, t_cloud, ux, uy, uz, dx, dy, dz, pixel_rad, st)
    if t_ground > 0.0:
        return ON_GROUND
    return ON_CLOUD if has_cloud else IN_AIR


@fast_inlined_kernel
def _ground_state(eye, world, t, ux, uy, uz, dx, dy, dz, nu, pixel_rad, st):
    to = eye.sun
    x, y, z = _place(eye.origin, t, ux, uy, uz)
    lon, lat = math.atan2(y, x), math.asin(min(1.0, max(-1.0, z)))
    st[X], st[X + 1], st[X + 2], st[LON], st[LAT] = x, y, z, lon, lat
    mu = x * to[0] + y * to[1] + z * to[2]
    cos_view = min(1.0, max(0.01, -(x * dx + y * dy + z * dz)))
    footprint = pixel_rad * t / math.sqrt(cos_view)
    st[FOOTPRINT], st[MU], st[COS_VIEW] = footprint, mu, cos_view
    ring = math.sqrt(max(1e-9, x * x + y * y))
    st[SUN_EAST], st[SUN_NORTH] = (x * to[1] - y * to[0]) / ring, (to[2] - z * mu) / ring
    night = 1.0 if eye.city_lights else 0.0
    night *= min(1.0, max(0.0, 0.5 - mu * 8.0))
    for k in range(3):
        st[NIGHT + k] = night * st[DIRECT + k]
    _light(eye, world, 1.0, mu, st, DIRECT, DIFFUSE)
    wind = wind_mps(world.clouds.noise, x, y, z)
    mirror = math.pi * glint(cos_view, mu, -nu, wind)
    for k in range(3):
        st[MIRROR + k] = mirror * st[DIRECT + k]
    st[MIRROR_SKY] = fresnel_water(cos_view)
    st[SHADOW] = 0.0
    _sunward(eye, x, y, z, st)
    if mu > 0.0 and world.clouds.threshold < cl.NONE:
        away = 0.6 * CLOUD_TOP_M / max(mu, 0.08)
        wide = max(1.5e3, footprint)
        st[SHADOW] = cl.opacity(world.clouds, _field_sunward(world, x, y, z, lon, lat, away, wide, st), 1.0)


@fast_inlined_kernel
def _sunward(eye, x, y, z, st):
    """Unit step along the ground towards the Sun into st[TOWARD:]."""
    to = eye.sun
    up = x * to[0] + y * to[1] + z * to[2]
    tx, ty, tz = to[0] - up * x, to[1] - up * y, to[2] - up * z
    length = math.sqrt(max(1e-12, tx * tx + ty * ty + tz * tz))
    st[TOWARD], st[TOWARD + 1], st[TOWARD + 2] = tx / length, ty / length, tz / length


@fast_inlined_kernel
def _field_sunward(world, x, y, z, lon, lat, distance_m, footprint_m, st):
    """Cloud field at a place moved along st[TOWARD:]."""
    tx, ty, tz = st[TOWARD], st[TOWARD + 1], st[TOWARD + 2]
    s = distance_m / A_M
    ring2 = max(1e-4, x * x + y * y)
    d_lon, d_lat = s * (ty * x - tx * y) / ring2, s * tz / math.sqrt(ring2)
    return cl.field(world.clouds, x + s * tx, y + s * ty, z + s * tz, lon + d_lon, lat + d_lat, footprint_m)


@fast_inlined_kernel
def _cloud_state(eye, world, t, ux, uy, uz, dx, dy, dz, pixel_rad, st):
    to = eye.sun
    x, y, z = _place(eye.origin, t, ux, uy, uz)
    lon, lat = math.atan2(y, x), math.asin(min(1.0, max(-1.0, z)))
    st[CX], st[CX + 1], st[CX + 2] = x, y, z
    mu = x * to[0] + y * to[1] + z * to[2]
    cos_view = min(1.0, max(0.03, -(x * dx + y * dy + z * dz)))
    footprint = pixel_rad * t / math.sqrt(cos_view)
    st[FOOTPRINT], st[C_MU], st[C_SLANT] = footprint, max(0.0, mu), 1.0 / math.sqrt(cos_view)
    st[C_TILT] = math.sqrt(max(0.0, 1.0 - mu * mu)) / max(0.15, mu)
    _light(eye, world, CLOUD_TOP_M, mu, st, C_DIRECT, C_DIFFUSE)
    st[VALUE], st[HEAP], st[WARP] = cl.large(world.clouds, x, y, z, lon, lat, footprint)
    step = max(_SLOPE_STEP_M, footprint)
    _sunward(eye, x, y, z, st)
    there = _field_sunward(world, x, y, z, lon, lat, step, max(footprint, 30e3), st)
    st[SLOPE] = (there - st[VALUE]) / step
    st[CIRRUS] = cl.cirrus(world.clouds, x, y, z, lon, lat, footprint)
