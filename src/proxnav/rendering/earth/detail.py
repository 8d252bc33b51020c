"""What varies from pixel to pixel: ground, shore, waves and the edges and faces of clouds, on top of a ray's state."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import fast_inlined_kernel
from proxnav.rendering.earth import clouds as cl
from proxnav.rendering.earth import noise
from proxnav.rendering.earth import state as s
from proxnav.rendering.earth.ellipsoid import A_M
from proxnav.rendering.earth.imagery import CITY, LEVELS, SLOPE_EAST, SLOPE_NORTH, WATER
from proxnav.rendering.earth.surface import RELIEF, WATER_REFLECTANCE, read_ground

CITY_RADIANCE = np.array([1.6e-3, 1.1e-3, 0.5e-3])  # W/(m^2 sr) of a bright city centre
CLOUD_HEIGHT_M = 7e3  # m, height of a cloud's top per unit of field: what its shading sees


@fast_inlined_kernel
def _level(footprint_m, texel_m):
    level = 0
    while level < LEVELS - 1 and footprint_m > 1.5 * texel_m:
        texel_m *= 2.0
        level += 1
    return level


@fast_inlined_kernel
def _open_sea(level, lon, lat):
    """Whether there is nothing but water for tens of kilometres around."""
    rows, columns = level.shape[0], level.shape[1]
    i = int(min(max((0.5 - lat / math.pi) * rows - 0.5, 0.0), rows - 2.0))
    j = int(min(max((lon / (2.0 * math.pi) + 0.5) * columns - 0.5, 0.0), columns - 2.0))
    return (
        level[i, j, WATER] == 255
        and level[i, j + 1, WATER] == 255
        and level[i + 1, j, WATER] == 255
        and level[i + 1, j + 1, WATER] == 255
    )


@fast_inlined_kernel
def _ground(eye, world, st, m, out):
    footprint = st[s.FOOTPRINT]
    texel = 2.0 * math.pi * A_M / world.ground[0].shape[1]
    rough, cells, fine, patches, facing = 0.0, 0.0, 0.0, 0.0, 0.0
    inland = not _open_sea(world.ground[3], st[s.LON], st[s.LAT])
    if inland and footprint < 4e3:
        x, y, z = st[s.X], st[s.X + 1], st[s.X + 2]
        rough, cells = noise.sample(world.clouds.noise, x * 90.0, y * 90.0, z * 90.0)
        weight = 1.0 - footprint / 4e3
        rough, cells = rough * weight, cells * weight
        if footprint < 1200.0:
            fine, patches = noise.sample(world.clouds.noise, x * 640.0, y * 640.0, z * 640.0)
            weight = 1.0 - footprint / 1200.0
            fine, patches = fine * weight, patches * weight
            d, t = 1.2 * max(footprint, 200.0) / A_M * 640.0, s.TOWARD
            there, _ = noise.sample(
                world.clouds.noise, x * 640.0 + d * st[t], y * 640.0 + d * st[t + 1], z * 640.0 + d * st[t + 2]
            )
            facing = (fine - there * weight) / max(1.0, footprint / 200.0)
    bend = 0.30 * texel / A_M
    lon = st[s.LON] + bend * (0.9 * rough + 0.35 * fine)
    lat = st[s.LAT] + bend * (0.7 * cells + 0.35 * patches)
    read_ground(world.ground[_level(footprint, texel)], lon, lat, m)
    water = m[WATER]
    if 0.02 < water < 0.98:
        water = min(1.0, max(0.0, (water + 0.10 * fine - 0.5) * 6.0 + 0.5))
    clear = 1.0 - 0.85 * st[s.SHADOW]
    rugged = math.sqrt(m[SLOPE_EAST] ** 2 + m[SLOPE_NORTH] ** 2)
    sun = st[s.MU] - RELIEF * (m[SLOPE_EAST] * st[s.SUN_EAST] + m[SLOPE_NORTH] * st[s.SUN_NORTH]) * (1.0 - water)
    sun += math.sqrt(max(0.0, 1.0 - st[s.MU] ** 2)) * min(0.6, 0.05 + 0.8 * rugged) * facing
    lit = min(1.0, max(0.0, sun)) * clear
    grain = max(0.4, 1.0 + 0.05 * rough + 0.05 * cells + 0.06 * fine + 0.09 * patches)
    night = m[CITY] > 0.0 and st[s.NIGHT + 1] > 0.0
    sparkle = math.exp(1.6 * patches + 0.9 * fine - 0.8) * m[CITY] if night else 0.0
    for k in range(3):
        hue = 1.0 + (0.02 * (k - 1)) * (rough - 1.5 * patches)
        albedo = m[k] * grain * hue * (1.0 - water) + WATER_REFLECTANCE[k] * water
        sea = water * (st[s.MIRROR + k] * clear + st[s.MIRROR_SKY] * st[s.DIFFUSE + k])
        lamps = sparkle * CITY_RADIANCE[k] * st[s.NIGHT + k]
        out[k] = albedo * (st[s.DIRECT + k] * lit + st[s.DIFFUSE + k]) + sea + lamps + st[s.AIR + k]


@fast_inlined_kernel
def _cloud_field(world, st):
    """Value of the whole field and its slope towards the Sun [1/m]."""
    c = world.clouds
    value, slope, footprint = st[s.VALUE], st[s.SLOPE], st[s.FOOTPRINT]
    if value < c.threshold - 0.32:
        return value, slope
    x, y, z, heap, warp = st[s.CX], st[s.CX + 1], st[s.CX + 2], st[s.HEAP], st[s.WARP]
    weight1 = cl.fade(footprint, cl.PERIODS_M[1]) * cl.WEIGHTS[1]
    if weight1 <= 0.0:
        return value, slope
    here1 = cl.fine(c, 1, x, y, z, heap, warp)
    value += weight1 * here1
    weight2, here2 = cl.fade(footprint, cl.PERIODS_M[2]) * cl.WEIGHTS[2], 0.0
    if value < c.threshold - 0.15 or weight2 <= 0.0:
        weight2 = 0.0  # nothing that is left can make it a cloud
    else:
        here2 = cl.fine(c, 2, x, y, z, heap, warp)
    middle, value = value, value + weight2 * here2
    if value <= c.threshold:
        return value, slope  # no cloud: its slope shades nothing
    if middle > c.threshold - 0.1:
        slope += weight1 * _rise(c, 1, here1, x, y, z, st)
    if weight2 > 0.0:
        slope += weight2 * _rise(c, 2, here2, x, y, z, st)
    return value, slope


@fast_inlined_kernel
def _rise(clouds, layer, here, x, y, z, st):
    """Slope towards the Sun [1/m] of a layer of detail whose value is `here`."""
    step = max(1.3 * st[s.FOOTPRINT], 0.012 * cl.PERIODS_M[layer])
    d, t = step / A_M, s.TOWARD
    there = cl.fine(clouds, layer, x + d * st[t], y + d * st[t + 1], z + d * st[t + 2], st[s.HEAP], st[s.WARP])
    return (there - here) / step


@fast_inlined_kernel
def _over(st, share, albedo, lit, out):
    for k in range(3):
        white = albedo * (st[s.C_DIRECT + k] * st[s.C_MU] * lit + 0.6 * st[s.C_DIFFUSE + k]) + st[s.C_AIR + k]
        out[k] += share * (white - out[k])


@fast_inlined_kernel
def radiance(eye, world, ends, st, m, out):
    """Radiance [W/(m^2 sr)] of a ray that ends on Earth, from its state; `m` (7) is room for a map reading."""
    value, slope, share = 0.0, 0.0, 0.0
    clouded = world.clouds.threshold < cl.NONE
    if clouded:
        value, slope = _cloud_field(world, st)
        share = cl.opacity(world.clouds, value, st[s.C_SLANT])
    if share > 0.998:
        share = 1.0  # nothing of the ground: it is not looked at
    elif ends == s.ON_GROUND:
        _ground(eye, world, st, m, out)
    if share > 0.0:
        lit = min(1.3, max(0.30, 1.0 - 0.45 * CLOUD_HEIGHT_M * slope * st[s.C_TILT]))
        thick = max(0.0, value - world.clouds.threshold)
        _over(st, share, 0.82 - 0.47 * math.exp(-thick / 0.15), lit, out)
    if clouded and st[s.CIRRUS] > 0.0:
        _over(st, 1.0 - (1.0 - st[s.CIRRUS]) ** st[s.C_SLANT], 0.62, 1.0, out)
