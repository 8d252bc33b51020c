"""What the Sun does to a lens that it shines into: disc, scattered light, starburst and ghosts.

Everything is computed as the radiance that would give the same irradiance on the detector, so that it adds to the
scene's. Sun outside the field counts until the hood hides it; Sun hidden by the target or by Earth does nothing.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float32

from proxnav.geometry import Camera
from proxnav.geometry.arrays import unit
from proxnav.geometry.celestial import SUN_HALF_ANGLE
from proxnav.geometry.compiled.kernel import kernel
from proxnav.records import RenderedFrame, SceneSpec, SensorSpec, Window
from proxnav.sensor import noise
from proxnav.sensor.blur import Image
from proxnav.sensor.photometry import BAND_CENTRES_M, electrons_per_radiance, focal_length_m

HOOD_CUTOFF = math.radians(60.0)
"""Angle [rad] from the boresight beyond which no sunlight reaches the front lens."""
_SCATTER_CORE = 0.02  # rad, where the scatter of polished glass bends from a plateau to 1/angle^2 (Harvey)
_DARKENING = np.array([0.50, 0.62, 0.75])  # linear limb darkening in the three bands (Allen, Astrophysical Quantities)


@dataclass(frozen=True, slots=True, eq=False)
class SunInLens:
    """The Sun as this camera sees it."""

    direction_cam: Float[np.ndarray, "3"]
    """Unit vector to the Sun, camera axes."""
    centre_px: Float[np.ndarray, "2"]
    """Where it is imaged; outside the image when the Sun is outside the field."""
    irradiance: Float[np.ndarray, "band=3"]
    """W/m^2 that enter the front lens: what is left after eclipse, occlusion and hood."""


@dataclass(frozen=True, slots=True, eq=False)
class FlarePart:
    """Light that one effect adds to a box of the window."""

    box: tuple[slice, slice]
    """(rows, columns) of the window."""
    shape: Float32[np.ndarray, "rows columns"]
    """Radiance for an irradiance of 1 [1/sr]."""
    colour: Float[np.ndarray, "band=3"]
    """Factor of each band."""


def sun_in_lens(frame: RenderedFrame, scene: SceneSpec, camera: Camera) -> SunInLens | None:
    """The Sun before this camera, or None where no sunlight enters the lens."""
    direction = unit(scene.T_cam_target.R @ np.array(scene.sun.direction_target))
    angle = math.acos(min(max(direction[2], -1.0), 1.0))
    share = scene.sun.visible_fraction * _hood(angle, scene.camera)
    if share <= 0.0:
        return None
    centre = camera.project(direction)
    if not (np.isfinite(centre).all() and camera.contains(centre)):
        centre = camera.undistorted().project(direction)
    share *= 1.0 - _hidden_share(frame, centre, SUN_HALF_ANGLE * camera.fx)
    if share <= 1e-4:
        return None
    return SunInLens(direction, centre, np.array(scene.sun.irradiance) * share * direction[2])


def add_flare(rate: Image, frame: RenderedFrame, scene: SceneSpec, camera: Camera) -> Image:
    """Electron rate with the Sun's light in the lens added; the argument itself when there is none."""
    sun = sun_in_lens(frame, scene, camera)
    if sun is None:
        return rate
    weights = electrons_per_radiance(scene.sensor) * sun.irradiance
    out = rate.copy()
    _brighten_disc(out, frame, camera, sun, weights)
    for part in _parts(frame, scene, camera, sun):
        band_weights = (part.colour * weights).astype(np.float32)
        out[part.box] += part.shape * band_weights.sum() if rate.ndim == 2 else part.shape[..., None] * band_weights
    return out


def _parts(frame: RenderedFrame, scene: SceneSpec, camera: Camera, sun: SunInLens) -> list[FlarePart]:
    sensor, window = scene.sensor, frame.window
    everywhere = (slice(0, window.height), slice(0, window.width))
    scattered = scatter(window, camera, sun) * np.float32(sensor.sun_scatter)
    parts = [FlarePart(everywhere, scattered, np.ones(3))]
    if sensor.aperture_blades > 0:
        # the strength of diffraction goes with the wavelength; the shape is computed at the green band's
        star = starburst(window, camera, scene.camera, sensor, sun)
        parts.append(FlarePart(everywhere, star, BAND_CENTRES_M / BAND_CENTRES_M[1]))
    return parts + ghosts(window, camera, sensor, sun)


def _hood(angle: float, camera: Camera) -> float:
    """Share of the light that passes the hood: 1 in the field, falling to 0 at the cut-off."""
    half_field = math.atan(0.5 * math.hypot(camera.width / camera.fx, camera.height / camera.fy))
    if angle <= half_field:
        return 1.0
    x = (angle - half_field) / max(HOOD_CUTOFF - half_field, 1e-6)
    return (1.0 - x) ** 2 if x < 1.0 else 0.0


def _hidden_share(frame: RenderedFrame, centre_px: Float[np.ndarray, "2"], radius_px: float) -> float:
    """Share of the solar disc that the target covers, as far as this window shows it."""
    rows, columns, inside = _disc_cells(frame.window, centre_px, radius_px)
    return float(frame.coverage[rows, columns][inside].mean()) if inside.any() else 0.0


def _disc_cells(
    window: Window, centre_px: Float[np.ndarray, "2"], radius_px: float
) -> tuple[slice, slice, Bool[np.ndarray, "rows columns"]]:
    """(rows, columns) of the box about a disc in the window, and which pixels of it have their centre in the disc."""
    x, y = centre_px[0] - window.x, centre_px[1] - window.y
    reach = max(radius_px, 0.75)
    columns = slice(max(int(x - reach), 0), max(min(int(x + reach) + 2, window.width), 0))
    rows = slice(max(int(y - reach), 0), max(min(int(y + reach) + 2, window.height), 0))
    dx = np.arange(columns.start, max(columns.stop, columns.start)) + 0.5 - x
    dy = np.arange(rows.start, max(rows.stop, rows.start)) + 0.5 - y
    return rows, columns, dx**2 + dy[:, None] ** 2 <= reach**2


def _brighten_disc(
    rate: Image, frame: RenderedFrame, camera: Camera, sun: SunInLens, weights: Float[np.ndarray, "band=3"]
) -> None:
    """Raise `rate` in place to the limb-darkened disc; a renderer may have drawn it already, the brighter is kept."""
    radius = SUN_HALF_ANGLE * camera.fx
    rows, columns, inside = _disc_cells(frame.window, sun.centre_px, radius + 1.0)
    if not inside.any():
        return
    y, x = np.mgrid[rows, columns] + 0.5
    r = np.hypot(x + frame.window.x - sun.centre_px[0], y + frame.window.y - sun.centre_px[1]) / radius
    mu = np.sqrt(np.clip(1.0 - r**2, 0.0, 1.0))[..., None]
    soft = np.clip((1.0 - r) * radius + 0.5, 0.0, 1.0) * (1.0 - frame.coverage[rows, columns])
    mean = 1.0 - _DARKENING / 3.0
    profile = soft[..., None] * (1.0 - _DARKENING * (1.0 - mu)) / (mean * np.pi * SUN_HALF_ANGLE**2)
    disc = profile * weights
    rate[rows, columns] = np.maximum(rate[rows, columns], disc.sum(axis=-1) if rate.ndim == 2 else disc)


def scatter(window: Window, camera: Camera, sun: SunInLens) -> Float[np.ndarray, "height width"]:
    """Distribution [1/sr] of the light that the glass scatters: a plateau, then 1/angle^2; 1 over the half space.

    J. E. Harvey's shift-invariant surface scatter with slope -2, in the chord: 1/(1 + c^2/c0^2), whose integral over
    the half space is pi c0^2 ln(1 + 2/c0^2).
    """
    out = np.empty((window.height, window.width), dtype=np.float32)
    core2 = _SCATTER_CORE**2
    peak = 1.0 / (np.pi * core2 * np.log1p(2.0 / core2))
    _scatter(out, window.x, window.y, camera.fx, camera.fy, camera.cx, camera.cy, sun.direction_cam, core2, peak)
    return out


@kernel
def _scatter(out, x0, y0, fx, fy, cx, cy, sun, core2, peak):
    for i in range(out.shape[0]):
        y = (y0 + i + 0.5 - cy) / fy
        for j in range(out.shape[1]):
            x = (x0 + j + 0.5 - cx) / fx
            scale = 1.0 / np.sqrt(x * x + y * y + 1.0)
            chord2 = (x * scale - sun[0]) ** 2 + (y * scale - sun[1]) ** 2 + (scale - sun[2]) ** 2
            out[i, j] = peak / (1.0 + chord2 / core2)


def starburst(
    window: Window, camera: Camera, full_camera: Camera, sensor: SensorSpec, sun: SunInLens
) -> Float[np.ndarray, "height width"]:
    """Diffraction [1/sr] by the straight edges of the iris, smeared by the Sun's disc.

    Far from its source an edge of length l gives |FT|^2 / (lambda^2 A) = (l / (2 pi phi_n))^2 sinc^2(l phi_t / lambda)
    / A; across the spike sinc^2 holds lambda / l, which the disc (and a slight curvature of the blade) spreads.
    """
    diameter = focal_length_m(sensor, full_camera) / sensor.f_number
    blades = sensor.aperture_blades
    edge, area = diameter * math.sin(math.pi / blades), 0.25 * math.pi * diameter**2
    strength = edge * BAND_CENTRES_M[1] / (4.0 * math.pi**2 * area)
    lens = noise.generator(sensor.serial, "iris")
    turn = lens.random() * 2.0 * np.pi + lens.normal(0.0, 0.005, blades)
    angles = turn + np.arange(blades) * 2.0 * np.pi / blades
    fan = np.tan(np.abs(lens.normal(0.012, 0.005, blades)))  # rad, curvature of each blade
    weights = strength * lens.uniform(0.6, 1.4, blades)
    out = np.zeros((window.height, window.width), dtype=np.float32)
    x, y = sun.centre_px[0] - window.x, sun.centre_px[1] - window.y
    _starburst(out, x, y, camera.fx, SUN_HALF_ANGLE, np.cos(angles), np.sin(angles), fan, weights)
    return out


@kernel
def _starburst(out, x, y, f, radius, c, s, fan, weights):
    height, width = out.shape
    farthest = (abs(x) + abs(y) + width + height) / f
    for k in range(len(c)):
        widest = np.sqrt(radius * radius + (farthest * fan[k]) ** 2)
        for i in range(height):
            v = (i + 0.5 - y) / f
            # columns of this row that the spike can reach: |v c - u s| < widest
            first, last = 0, width
            if abs(s[k]) > 1e-6:
                middle, reach = v * c[k] / s[k] * f + x, widest / abs(s[k]) * f
                first = int(min(max(middle - reach, 0.0), width))
                last = int(min(max(middle + reach + 1.0, 0.0), width))
            for j in range(first, last):
                u = (j + 0.5 - x) / f
                along = u * c[k] + v * s[k]
                across = v * c[k] - u * s[k]
                half = np.sqrt(radius * radius + (along * fan[k]) ** 2)
                t = across / half
                if t * t < 1.0:
                    # (1 - t^2)^2 with unit integral: the disc's chord, rounded by what the model leaves out
                    profile = 0.9375 * (1.0 - t * t) ** 2 / half
                    out[i, j] += weights[k] * profile / (along * along + radius * radius)


@dataclass(frozen=True, slots=True)
class _Ghost:
    place: float
    """Position on the line from the principal point (0) to the Sun's image (1)."""
    radius: float
    """Radius of the patch, in units of the focal length."""
    share: float
    """Share of the light that enters the lens: the product of two reflectances."""
    colour: tuple[float, float, float]
    """Tint by the coatings."""
    rim: float
    """How much brighter the edge is than the middle (spherical aberration)."""


def lens_ghosts(sensor: SensorSpec) -> list["_Ghost"]:
    """The pairs of lens surfaces that send light twice back, fixed by the camera's serial."""
    lens = noise.generator(sensor.serial, "ghosts")
    ghosts = []
    for _ in range(8):
        place = lens.uniform(-1.4, 0.8)
        radius = math.exp(lens.uniform(math.log(0.012), math.log(0.14)))
        reflectances = np.exp(lens.uniform(math.log(0.0015), math.log(0.008), 2))
        tint = np.clip(lens.normal(1.0, 0.35, 3), 0.25, 2.0)
        ghosts.append(_Ghost(place, radius, float(reflectances.prod()), tuple(tint / tint.mean()), lens.uniform(0, 1)))
    return ghosts


def ghosts(window: Window, camera: Camera, sensor: SensorSpec, sun: SunInLens) -> list[FlarePart]:
    """The ghosts that reach the window: out-of-focus images of the iris, on the line through the principal point."""
    axis = np.array([camera.cx, camera.cy])
    turn = noise.generator(sensor.serial, "iris").random() * 2.0 * np.pi
    found = []
    for ghost in lens_ghosts(sensor):
        centre = axis + ghost.place * (sun.centre_px - axis) - (window.x, window.y)
        radius_px = ghost.radius * camera.fx
        box = _box(window, centre, 1.1 * radius_px + 2.0)
        if box is None:
            continue
        shape = np.zeros((box[0].stop - box[0].start, box[1].stop - box[1].start), dtype=np.float32)
        # the barrel cuts the pencil of rays the more the farther the Sun is off the axis
        cut = (axis - sun.centre_px) / camera.fx * 0.9 * np.sign(ghost.place) * radius_px
        level = ghost.share / (np.pi * ghost.radius**2)
        x, y = centre - (box[1].start, box[0].start)
        _ghost(shape, x, y, radius_px, sensor.aperture_blades, turn, level, ghost.rim, cut[0], cut[1])
        found.append(FlarePart(box, shape, np.array(ghost.colour)))
    return found


def _box(window: Window, centre: Float[np.ndarray, "2"], reach_px: float) -> tuple[slice, slice] | None:
    """(rows, columns) of the part of the window within reach of a point in it; None when that is empty."""
    low = np.maximum(np.floor(centre - reach_px), 0.0).astype(int)
    high = np.minimum(np.ceil(centre + reach_px), (window.width, window.height)).astype(int)
    if (high <= low).any():
        return None
    return slice(int(low[1]), int(high[1])), slice(int(low[0]), int(high[0]))


@kernel
def _ghost(out, x, y, radius, blades, turn, level, rim, cut_x, cut_y):
    """Fill the polygon (rounded, soft-edged) that the barrel's shifted circle leaves."""
    soft = max(0.06 * radius, 1.0)
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            u, v = j + 0.5 - x, i + 0.5 - y
            r = np.sqrt(u * u + v * v)
            if r > radius + soft:
                continue
            limit = radius
            if blades > 2 and r > 0.5 * radius:  # well inside, the shape of the edge does not matter
                sector = 2.0 * np.pi / blades
                turned = (np.arctan2(v, u) - turn) % sector - 0.5 * sector
                flat = np.cos(0.5 * sector) / np.cos(turned)
                limit = radius * (0.5 + 0.5 * flat)  # blades are curved: halfway between circle and polygon
            barrel = 1.15 * radius - np.sqrt((u - cut_x) ** 2 + (v - cut_y) ** 2)
            inside = min(limit - r, barrel) / soft
            if inside > -0.5:
                edge = min(inside + 0.5, 1.0)
                out[i, j] = level * edge * edge * (3.0 - 2.0 * edge) * (1.0 + rim * ((r / radius) ** 4 - 1.0 / 3.0))
