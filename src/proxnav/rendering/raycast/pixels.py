"""Which pixels need more than one ray, and where inside the pixel and on the Sun's disc those rays go.

Everything here depends on the pixel's place in the image alone, never on the window that is being rendered.
"""

import numpy as np
from jaxtyping import Float, Int

from proxnav.geometry.compiled.kernel import ray_kernel
from proxnav.geometry.compiled.vectors import cross, dot, minus, over, plus, put

_PLASTIC = np.array([0.7548776662466927, 0.5698402909980532])
"""M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018: the R2 sequence."""
_CREASE_COSINE = 0.94


def pixel_pattern(count: int) -> Float[np.ndarray, "count 2"]:
    """Places in a pixel, evenly spread, whose mean is the pixel's centre (0.5, 0.5)."""
    places = (0.5 + _PLASTIC * np.arange(count)[:, None]) % 1.0
    return places - places.mean(axis=0) + 0.5


def sample_places(pixels: Int[np.ndarray, "n 2"], count: int) -> Float[np.ndarray, "n_times_count 2"]:
    """Points [px] of the samples of pixels (x, y), sample by sample within each pixel."""
    return (pixels[:, None, :] + pixel_pattern(count)).reshape(-1, 2)


@ray_kernel
def _mix(x, y):
    """Two numbers in [0, 1) that look random, from integer pixel coordinates (finaliser of MurmurHash3)."""
    h = np.uint64(x & 0xFFFFFFFF) * np.uint64(0x9E3779B97F4A7C15) ^ np.uint64(y & 0xFFFFFFFF) * np.uint64(
        0xC2B2AE3D27D4EB4F
    )
    h = (h ^ (h >> np.uint64(33))) * np.uint64(0xFF51AFD7ED558CCD)
    h = (h ^ (h >> np.uint64(33))) * np.uint64(0xC4CEB9FE1A85EC53)
    h = h ^ (h >> np.uint64(33))
    return np.float64(h >> np.uint64(40)) / 16777216.0, np.float64(
        (h >> np.uint64(8)) & np.uint64(0xFFFFFF)
    ) / 16777216.0


@ray_kernel
def sun_points(pixels, per_pixel, step, steps, centre, half_angle, out):
    """Fills a direction (n * per_pixel, 3) on the Sun's disc for every sample: the step-th of `steps` in each."""
    u = cross((1.0, 0.0, 0.0) if abs(centre[0]) < 0.6 else (0.0, 1.0, 0.0), centre)
    u = over(u, np.sqrt(dot(u, u)))
    v = cross(centre, u)
    for i in range(pixels.shape[0]):
        a, b = _mix(pixels[i, 0], pixels[i, 1])
        for k in range(per_pixel):
            n = k * steps + step
            # stratified radius, golden angle: an even disc for any count
            share = (a + (n + 0.5) / (per_pixel * steps)) % 1.0
            r, phi = half_angle * np.sqrt(share), 2.0 * np.pi * (b + n * 0.6180339887498949)
            put(out[i * per_pixel + k], 0, plus(plus(centre, r * np.cos(phi), u), r * np.sin(phi), v))


@ray_kernel
def mark_edges(hit, triangle, position, depth, normals, part, pixel_rad, marked):
    """Marks pixels of a grid (h, w) of hit indices, -1 for none, between which the surface ends, folds or jumps."""
    h, w = hit.shape
    for y in range(h):
        for x in range(w):
            for dy, dx in ((0, 1), (1, -1), (1, 0), (1, 1)):
                yy, xx = y + dy, x + dx
                if yy >= h or xx < 0 or xx >= w:
                    continue
                i, j = hit[y, x], hit[yy, xx]
                if (i < 0 and j < 0) or (i >= 0 and j >= 0 and triangle[i] == triangle[j]):
                    continue
                if (
                    i < 0
                    or j < 0
                    or _breaks(triangle[i], triangle[j], position[i], position[j], normals, part, depth[i] * pixel_rad)
                ):
                    marked[y, x] = True
                    marked[yy, xx] = True


@ray_kernel
def _breaks(a, b, p, q, normals, part, pixel_m):
    """Whether two points on triangles a and b belong to different smooth surfaces."""
    if part[a] != part[b]:
        return True
    above_p, above_q = dot(minus(q, p), normals[a]), dot(minus(p, q), normals[b])
    return dot(normals[a], normals[b]) < _CREASE_COSINE or min(abs(above_p), abs(above_q)) > 0.5 * pixel_m


@ray_kernel
def mark_penumbra(hit, lit, blocker, depth, pixel_rad, half_angle, reach, marked):
    """Marks pixels of a grid (h, w) of hit indices that a shadow's edge may soften.

    `lit` is 1 in sunlight, 0 in a cast shadow and -1 where the question does not arise; `blocker` [m] is the distance
    to what casts the shadow, whose penumbra is 2 `half_angle` times that wide.
    """
    h, w = hit.shape
    for y in range(h):
        for x in range(w):
            i = hit[y, x]
            if i < 0 or lit[i] != 0:
                continue
            edge = False
            for yy in range(max(0, y - 1), min(h, y + 2)):
                for xx in range(max(0, x - 1), min(w, x + 2)):
                    edge = edge or (hit[yy, xx] >= 0 and lit[hit[yy, xx]] == 1)
            if not edge:
                continue
            r = min(reach, 1 + int(1.5 * half_angle * blocker[i] / (depth[i] * pixel_rad)))
            for yy in range(max(0, y - r), min(h, y + r + 1)):
                for xx in range(max(0, x - r), min(w, x + r + 1)):
                    if hit[yy, xx] >= 0 and lit[hit[yy, xx]] >= 0:
                        marked[yy, xx] = True


def grid_pixels(x: int, y: int, width: int, height: int) -> Int[np.ndarray, "n 2"]:
    """Coordinates (x, y) of the pixels of a rectangle, row-major."""
    columns, rows = np.meshgrid(np.arange(x, x + width), np.arange(y, y + height))
    return np.stack([columns.ravel(), rows.ravel()], axis=-1)
