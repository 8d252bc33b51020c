"""One ray: what comes down it from Earth, its clouds, its air and the Sun."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from proxnav.rendering.earth import noise, sun
from proxnav.rendering.earth.aerial import CLOUD, CLOUD_TOP_M, GROUND, SKY, look
from proxnav.rendering.earth.atmosphere import SUN_MU_MAX, SUN_MU_MIN, SUN_NODES, sun_transmittance
from proxnav.rendering.earth.clouds import Clouds, density, field
from proxnav.rendering.earth.ellipsoid import A_M, STRETCH, near_hit
from proxnav.rendering.earth.imagery import LEVELS, SLOPE_EAST, SLOPE_NORTH, WATER
from proxnav.rendering.earth.surface import RELIEF, WATER_REFLECTANCE, WIND_MPS, fresnel_water, glint, read_ground

CITY_RADIANCE = np.array([1.6e-3, 1.1e-3, 0.5e-3])  # W/(m^2 sr) of a bright city centre


class Eye(NamedTuple):
    """Where the ray starts and where the light comes from, in Earth-fixed axes."""

    origin: np.ndarray
    """(3) stretched [m]."""
    sun: np.ndarray
    """(3) unit, true."""
    sun_stretched: np.ndarray
    """(3) unit, stretched."""
    irradiance: np.ndarray
    """(3) of the Sun [W/m^2]."""
    show_sun: bool
    atmosphere: bool
    city_lights: bool


class World(NamedTuple):
    """What stays the same from frame to frame, and the clouds of this one."""

    transmittance: np.ndarray
    multiple: np.ndarray
    sky_irradiance: np.ndarray
    ground: tuple[np.ndarray, ...]
    clouds: Clouds


class Scratch(NamedTuple):
    """Room for the values of one ray."""

    light: np.ndarray
    through: np.ndarray
    layer: np.ndarray
    map: np.ndarray


def scratch() -> Scratch:
    """Fresh room for one ray."""
    return Scratch(np.zeros(3), np.ones(3), np.zeros(3), np.zeros(7))


@njit(cache=True, nogil=True)
def _sky_light(world, mu, band):
    x = (mu - SUN_MU_MIN) / (SUN_MU_MAX - SUN_MU_MIN) * (SUN_NODES - 1)
    x = min(SUN_NODES - 1.001, max(0.0, x))
    j = int(x)
    return (1.0 - (x - j)) * world.sky_irradiance[j, band] + (x - j) * world.sky_irradiance[j + 1, band]


@njit(cache=True, nogil=True)
def _level(footprint_m):
    texel, level = 7.4e3, 0
    while level < LEVELS - 1 and footprint_m > 1.5 * texel:
        texel *= 2.0
        level += 1
    return level


@njit(cache=True, nogil=True)
def _place(eye, t, dx, dy, dz):
    """Unit normal (3), longitude and latitude where the stretched ray is after t."""
    x, y, z = eye.origin[0] + t * dx, eye.origin[1] + t * dy, (eye.origin[2] + t * dz) * STRETCH
    s = 1.0 / math.sqrt(x * x + y * y + z * z)
    x, y, z = x * s, y * s, z * s
    return x, y, z, math.atan2(y, x), math.asin(min(1.0, max(-1.0, z)))


@njit(cache=True, nogil=True)
def _moved(clouds, eye, x, y, z, lon, lat, distance_m, footprint_m):
    """Cloud field at a place moved by a distance towards the Sun along the ground."""
    up = x * eye.sun[0] + y * eye.sun[1] + z * eye.sun[2]
    tx, ty, tz = eye.sun[0] - up * x, eye.sun[1] - up * y, eye.sun[2] - up * z
    s = distance_m / (A_M * max(1e-6, math.sqrt(tx * tx + ty * ty + tz * tz)))
    ring2 = max(1e-4, x * x + y * y)
    ring = math.sqrt(ring2)
    d_lon = s * (ty * x - tx * y) / ring2
    d_lat = s * tz / ring if ring > 0.02 else 0.0
    return field(clouds, x + s * tx, y + s * ty, z + s * tz, lon + d_lon, lat + d_lat, footprint_m)


@njit(cache=True, nogil=True)
def _ground(world, eye, room, x, y, z, lon, lat, dx, dy, dz, footprint_m, out):
    """Radiance of the ground per unit Sun irradiance; (dx, dy, dz) is the true ray."""
    read_ground(world.ground[_level(footprint_m)], lon, lat, room.map)
    m = room.map
    mu_sun = x * eye.sun[0] + y * eye.sun[1] + z * eye.sun[2]
    cos_view = max(1e-3, -(x * dx + y * dy + z * dz))
    rough, fine = 0.0, 0.0
    if footprint_m < 4e3:
        rough, _ = noise.sample(world.clouds.noise, x * 160.0, y * 160.0, z * 160.0)
        fade = 1.0 - footprint_m / 4e3
        rough *= fade
        if footprint_m < 700.0:
            fine, _ = noise.sample(world.clouds.noise, x * 1300.0, y * 1300.0, z * 1300.0)
            fine *= 1.0 - footprint_m / 700.0
    edge = m[WATER] + 0.22 * rough + 0.08 * fine
    water = min(1.0, max(0.0, (edge - 0.5) * 4.0 + 0.5)) if 0.0 < m[WATER] < 1.0 else m[WATER]
    shade = 1.0
    if mu_sun > 0.0:
        over = CLOUD_TOP_M * 0.6 / max(mu_sun, 0.08)
        if world.clouds.threshold < 9.0:
            shadow = density(world.clouds, _moved(world.clouds, eye, x, y, z, lon, lat, over, footprint_m + 500.0))
            shade = 1.0 - 0.85 * shadow
    direct0, direct1, direct2 = 1.0, 1.0, 1.0
    if eye.atmosphere:
        direct0, direct1, direct2 = sun_transmittance(world.transmittance, A_M + 1.0, mu_sun)
    direct = (direct0, direct1, direct2)
    relief = mu_sun
    ring = math.sqrt(max(1e-9, x * x + y * y))
    sun_east = (-y * eye.sun[0] + x * eye.sun[1]) / ring
    sun_north = (eye.sun[2] - z * mu_sun) / ring
    relief = mu_sun - RELIEF * (m[SLOPE_EAST] * sun_east + m[SLOPE_NORTH] * sun_north) * (1.0 - water)
    relief = min(1.0, max(0.0, relief))
    between = -(dx * eye.sun[0] + dy * eye.sun[1] + dz * eye.sun[2])
    mirror = glint(cos_view, mu_sun, between, WIND_MPS) * water * shade if water > 0.0 else 0.0
    mirrored_sky = fresnel_water(cos_view) * water
    grain = max(0.3, 1.0 + 0.10 * rough + 0.07 * fine)
    for k in range(3):
        sky = _sky_light(world, mu_sun, k) if eye.atmosphere else 0.0
        land = m[k] * grain
        wet = WATER_REFLECTANCE[k]
        albedo = land + (wet - land) * water
        lit = direct[k] * relief * shade + sky
        out[k] = albedo / math.pi * lit + mirror * direct[k] + mirrored_sky * sky / math.pi


@njit(cache=True, nogil=True)
def _cloud(world, eye, x, y, z, lon, lat, cos_view, footprint_m, out):
    """Opacity of the cloud on its shell, and its radiance per unit Sun irradiance."""
    value = field(world.clouds, x, y, z, lon, lat, footprint_m)
    thick = density(world.clouds, value)
    if thick <= 0.0:
        return 0.0
    mu_sun = x * eye.sun[0] + y * eye.sun[1] + z * eye.sun[2]
    step = max(1500.0, 2.0 * footprint_m)
    toward = _moved(world.clouds, eye, x, y, z, lon, lat, step, footprint_m)
    slope = (value - toward) * (1500.0 / step)
    tilt = math.sqrt(max(0.0, 1.0 - mu_sun * mu_sun))
    lit = min(1.25, max(0.35, 1.0 + 6.0 * slope * tilt))
    albedo = 0.45 + 0.38 * thick
    direct0, direct1, direct2 = 1.0, 1.0, 1.0
    if eye.atmosphere:
        direct0, direct1, direct2 = sun_transmittance(world.transmittance, A_M + CLOUD_TOP_M, mu_sun)
    direct = (direct0, direct1, direct2)
    for k in range(3):
        sky = 0.6 * _sky_light(world, mu_sun, k) if eye.atmosphere else 0.0
        out[k] = albedo / math.pi * (max(0.0, mu_sun) * lit * direct[k] + sky)
    return 1.0 - math.exp(-3.2 * thick * thick / math.sqrt(max(0.05, cos_view)) - 0.8 * thick)


@njit(cache=True, nogil=True)
def shade(eye, world, aerial, room, dx, dy, dz, pixel_rad, out):
    """Radiance [W/(m^2 sr)] in three bands along the unit direction (dx, dy, dz) in Earth-fixed axes."""
    ux, uy, uz = dx, dy, dz * STRETCH
    s = 1.0 / math.sqrt(ux * ux + uy * uy + uz * uz)
    ux, uy, uz = ux * s, uy * s, uz * s
    o = eye.origin
    half_b = o[0] * ux + o[1] * uy + o[2] * uz
    down = -half_b / aerial.radius
    nu = dx * eye.sun[0] + dy * eye.sun[1] + dz * eye.sun[2]
    nu_flat = ux * eye.sun_stretched[0] + uy * eye.sun_stretched[1] + uz * eye.sun_stretched[2]
    sines = math.sqrt(max(1e-18, (1.0 - down * down) * (1.0 - aerial.mu_sun * aerial.mu_sun)))
    cos_azimuth = (nu_flat + down * aerial.mu_sun) / sines
    t_ground = near_hit(1.0, half_b, A_M, aerial.radius)
    in_air = eye.atmosphere and (t_ground > 0.0 or down > aerial.bounds[SKY, 1])
    out[:] = 0.0
    room.light[:] = 0.0
    room.through[:] = 1.0
    if in_air:
        kind = GROUND if t_ground > 0.0 else SKY
        look(aerial, world.transmittance, world.multiple, kind, down, cos_azimuth, nu, room.light, room.through)
    if t_ground > 0.0:
        x, y, z, lon, lat = _place(eye, t_ground, ux, uy, uz)
        cos_view = max(0.02, -(x * dx + y * dy + z * dz))
        footprint = pixel_rad * t_ground / math.sqrt(cos_view)
        _ground(world, eye, room, x, y, z, lon, lat, dx, dy, dz, footprint, out)
    elif eye.show_sun:
        for k in range(3):
            out[k] = sun.disc(nu, k)
    for k in range(3):
        out[k] = out[k] * room.through[k] + room.light[k]
    t_cloud = near_hit(1.0, half_b, A_M + CLOUD_TOP_M, aerial.radius)
    if t_cloud > 0.0 and world.clouds.threshold < 9.0:
        x, y, z, lon, lat = _place(eye, t_cloud, ux, uy, uz)
        cos_view = max(0.02, -(x * dx + y * dy + z * dz))
        footprint = pixel_rad * t_cloud / math.sqrt(cos_view)
        opacity = _cloud(world, eye, x, y, z, lon, lat, cos_view, footprint, room.layer)
        if opacity > 0.0:
            if eye.atmosphere:
                look(
                    aerial, world.transmittance, world.multiple, CLOUD, down, cos_azimuth, nu, room.light, room.through
                )
            for k in range(3):
                over = room.layer[k] * room.through[k] + room.light[k]
                out[k] += opacity * (over - out[k])
    for k in range(3):
        out[k] *= eye.irradiance[k]


@njit(cache=True, nogil=True)
def shade_many(eye, world, aerial, room, directions, pixel_rad, out):
    """`shade` for rays (n, 3); rays that are not numbers stay dark."""
    value = np.zeros(3)
    for i in range(len(directions)):
        dx, dy, dz = directions[i, 0], directions[i, 1], directions[i, 2]
        if dx == dx:
            shade(eye, world, aerial, room, dx, dy, dz, pixel_rad, value)
            for k in range(3):
                out[i, k] = value[k]
