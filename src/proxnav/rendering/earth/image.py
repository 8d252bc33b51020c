"""A whole image of Earth: states on a lattice of blocks, interpolated where they vary gently, exact where they do not.

The lattice is fixed to the full image, so a pixel gets the same value in every window that holds it.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Float32

from proxnav.geometry import Camera
from proxnav.geometry.celestial import SUN_HALF_ANGLE
from proxnav.geometry.compiled.kernel import fast_kernel
from proxnav.rendering.earth import moon, sun
from proxnav.rendering.earth import state as s
from proxnav.rendering.earth.detail import radiance
from proxnav.rendering.earth.ellipsoid import A_M

FINEST_BLOCK, WIDEST_BLOCK = 2, 8
BLOCK_RAD = 5.7e-3
"""Sides of a block [px], and the angle that it spans where these allow: 2.3 km below an eye at 400 km."""


def block_px(camera: Camera) -> int:
    """Side of a block of the camera's lattice."""
    block = WIDEST_BLOCK
    while block > FINEST_BLOCK and block > BLOCK_RAD * camera.fx:
        block //= 2
    return block


class Room(NamedTuple):
    """Scratch for one ray at a time."""

    air: Float[np.ndarray, "6"]
    state: Float32[np.ndarray, "size"]
    map: Float[np.ndarray, "channel=7"]
    value: Float[np.ndarray, "band=3"]
    left: Float32[np.ndarray, "size"]
    right: Float32[np.ndarray, "size"]


def room() -> Room:
    """Fresh scratch."""
    row = np.zeros((3, s.SIZE), dtype=np.float32)
    return Room(np.zeros(6), row[0].copy(), np.zeros(7), np.zeros(3), row[1].copy(), row[2].copy())


def lattice_size(block: int, x0: int, y0: int, width: int, height: int) -> tuple[int, int]:
    """(rows, columns) of lattice corners around a window."""
    return (y0 + height - 1) // block - y0 // block + 2, (x0 + width - 1) // block - x0 // block + 2


@lru_cache(maxsize=4)
def lattice_rays(camera: Camera) -> Float[np.ndarray, "rows columns 3"]:
    """Rays with z = 1 in the camera through the corners of the blocks; NaN where the lens has none."""
    block = block_px(camera)
    x = np.arange(-(-camera.width // block) + 1) * float(block)
    y = np.arange(-(-camera.height // block) + 1) * float(block)
    rays = camera.unproject(np.stack(np.meshgrid(x, y), axis=-1))
    rays.setflags(write=False)
    return rays


@fast_kernel
def shade_ray(eye, world, aerial, work, st, m, dx, dy, dz, pixel_rad, out):
    """Radiance [W/(m^2 sr)] down one unit ray in Earth-fixed axes, Sun's disc included."""
    for k in range(3):
        out[k] = 0.0
    ends = s.ray_state(eye, world, aerial, work, dx, dy, dz, pixel_rad, st)
    if ends != s.ON_GROUND and eye.show_sun:
        nu = dx * eye.sun[0] + dy * eye.sun[1] + dz * eye.sun[2]
        for k in range(3):
            through = 1.0 if ends == s.BEYOND or not eye.atmosphere else st[s.DIRECT + k]
            light = sun.disc(nu, k)
            if eye.moon_half_angle > 0.0:
                to_moon, to_sun = (eye.moon[0], eye.moon[1], eye.moon[2]), (eye.sun[0], eye.sun[1], eye.sun[2])
                light += moon.disc((dx, dy, dz), to_moon, to_sun, eye.moon_half_angle, k)
            out[k] = light * through * eye.irradiance[k]
    if ends == s.IN_AIR or ends == s.ON_CLOUD:
        for k in range(3):
            out[k] += st[s.AIR + k]
    if ends == s.ON_GROUND or ends == s.ON_CLOUD:
        radiance(eye, world, ends, st, m, out)


@fast_kernel
def shade_many(eye, world, aerial, room, directions, pixel_rad, out):
    """`shade_ray` for rays (n, 3); rays that are not numbers stay dark."""
    work, st, m, value = room.air, room.state, room.map, room.value
    for i in range(len(directions)):
        dx, dy, dz = directions[i, 0], directions[i, 1], directions[i, 2]
        if dx == dx:
            shade_ray(eye, world, aerial, work, st, m, dx, dy, dz, pixel_rad, value)
            for k in range(3):
                out[i, k] = value[k]


@fast_kernel
def _unit(x, y, z):
    n = 1.0 / math.sqrt(x * x + y * y + z * z)
    return x * n, y * n, z * n


@fast_kernel
def _corners(eye, world, aerial, work, rays, R, i0, j0, pixel_rad, states, ends):
    for i in range(states.shape[0]):
        for j in range(states.shape[1]):
            a, b, c = rays[i0 + i, j0 + j, 0], rays[i0 + i, j0 + j, 1], rays[i0 + i, j0 + j, 2]
            ends[i, j] = -1
            if a == a:
                x = R[0, 0] * a + R[0, 1] * b + R[0, 2] * c
                y = R[1, 0] * a + R[1, 1] * b + R[1, 2] * c
                z = R[2, 0] * a + R[2, 1] * b + R[2, 2] * c
                x, y, z = _unit(x, y, z)
                ends[i, j] = s.ray_state(eye, world, aerial, work, x, y, z, pixel_rad, states[i, j])


@fast_kernel
def _is_gentle(st, i, j):
    """Whether the four states around a block may be interpolated: landing points err by less than half a pixel."""
    lon_min, lon_max, cos_min = 9.0, -9.0, 1.0
    for a in range(2):
        for b in range(2):
            lon_min, lon_max = min(lon_min, st[i + a, j + b, s.LON]), max(lon_max, st[i + a, j + b, s.LON])
            cos_min = min(cos_min, st[i + a, j + b, s.COS_VIEW])
    if lon_max - lon_min > 0.5 or abs(st[i, j, s.X + 2]) > 0.996:
        return False
    d2 = 0.0
    for k in range(3):
        one = st[i + 1, j + 1, k] - st[i, j, k]
        two = st[i + 1, j, k] - st[i, j + 1, k]
        d2 += max(one * one, two * two)
    return d2 / (8.0 * cos_min * cos_min) < 0.5 * st[i, j, s.FOOTPRINT] / A_M


@fast_kernel
def draw(eye, world, aerial, room, states, ends, rays, R, block, x0, y0, pixel_rad, hidden, out):
    """Fills `out` (h, w, 3), the window whose first pixel is (x0, y0), but for pixels that are `hidden` (h, w).

    R turns camera axes to Earth-fixed axes.
    """
    h, w = out.shape[0], out.shape[1]
    i0, j0 = y0 // block, x0 // block
    n_i, n_j = states.shape[0] - 1, states.shape[1] - 1
    work, st, m, value, left, right = room.air, room.state, room.map, room.value, room.left, room.right
    _corners(eye, world, aerial, work, rays, R, i0, j0, pixel_rad, states, ends)
    for i in range(n_i):
        for j in range(n_j):
            low, high = 99, -99
            for a in range(2):
                for b in range(2):
                    low, high = min(low, ends[i + a, j + b]), max(high, ends[i + a, j + b])
            gentle = low == s.ON_GROUND and _is_gentle(states, i, j)
            if (
                high == s.BEYOND
                and low == s.BEYOND
                and not _holds_disc(eye, rays, i0 + i, j0 + j, R, block * pixel_rad)
            ):
                continue
            py0, py1 = max((i0 + i) * block, y0), min((i0 + i + 1) * block, y0 + h)
            px0, px1 = max((j0 + j) * block, x0), min((j0 + j + 1) * block, x0 + w)
            for py in range(py0, py1):
                fy = np.float32((py + 0.5) / block - (i0 + i))
                if gentle:
                    for k in range(s.SIZE):
                        left[k] = states[i, j, k] + fy * (states[i + 1, j, k] - states[i, j, k])
                        right[k] = states[i, j + 1, k] + fy * (states[i + 1, j + 1, k] - states[i, j + 1, k])
                        right[k] -= left[k]
                for px in range(px0, px1):
                    if hidden[py - y0, px - x0]:
                        continue
                    fx = np.float32((px + 0.5) / block - (j0 + j))
                    if gentle:
                        for k in range(s.SIZE):
                            st[k] = left[k] + fx * right[k]
                        radiance(eye, world, s.ON_GROUND, st, m, value)
                    else:
                        dx, dy, dz = _ray(rays, i0 + i, j0 + j, fy, fx, R)
                        if dx != dx:
                            continue
                        shade_ray(eye, world, aerial, work, st, m, dx, dy, dz, pixel_rad, value)
                    for k in range(3):
                        out[py - y0, px - x0, k] = value[k]


@fast_kernel
def _ray(rays, i, j, fy, fx, R):
    """Unit ray in Earth-fixed axes inside a block; between corners the lens is straight to 0.01 px."""
    w00, w01, w10, w11 = (1.0 - fy) * (1.0 - fx), (1.0 - fy) * fx, fy * (1.0 - fx), fy * fx
    a = w00 * rays[i, j, 0] + w01 * rays[i, j + 1, 0] + w10 * rays[i + 1, j, 0] + w11 * rays[i + 1, j + 1, 0]
    b = w00 * rays[i, j, 1] + w01 * rays[i, j + 1, 1] + w10 * rays[i + 1, j, 1] + w11 * rays[i + 1, j + 1, 1]
    x = R[0, 0] * a + R[0, 1] * b + R[0, 2]
    y = R[1, 0] * a + R[1, 1] * b + R[1, 2]
    z = R[2, 0] * a + R[2, 1] * b + R[2, 2]
    return _unit(x, y, z)


@fast_kernel
def _holds_disc(eye, rays, i, j, R, block_rad):
    """Whether a block may hold part of the Sun or the Moon."""
    x, y, z = _ray(rays, i, j, 0.5, 0.5, R)
    half = max(SUN_HALF_ANGLE, eye.moon_half_angle)
    cos_reach = math.cos(min(3.0, half + 1.5 * block_rad))
    to_sun = x * eye.sun[0] + y * eye.sun[1] + z * eye.sun[2]
    to_moon = x * eye.moon[0] + y * eye.moon[1] + z * eye.moon[2]
    return to_sun > cos_reach or to_moon > cos_reach
