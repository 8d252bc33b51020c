"""Where clouds are, at scales from a front to a continent: a map of noise stirred by a wind, as weather stirs moisture.

Points are traced backwards through a steady flow on the sphere (jets, cyclones and eddies from a stream function), and
noise is read where they came from. That draws fronts, commas and filaments; noise alone draws blobs.
"""

from functools import cache

import numpy as np
from jaxtyping import Float, Float32

from proxnav.rendering.earth.noise import SIZE, fractal
from proxnav.rendering.earth.stored import stored

ROWS, COLUMNS = 1024, 2048
Field = Float[np.ndarray, "rows columns"]
"""One number for each cell of the map."""


@cache
def weather() -> Float32[np.ndarray, "rows columns"]:
    """Rank in [0, 1] of each place by its moisture; north first, west first."""
    return stored("weather-2", _make)


def _grid() -> tuple[Field, Field]:
    lon = (np.arange(COLUMNS) + 0.5) / COLUMNS * 2.0 * np.pi - np.pi
    lat = np.pi / 2.0 - (np.arange(ROWS) + 0.5) / ROWS * np.pi
    return np.meshgrid(lon, lat)


def _on_sphere(lon: Field, lat: Field) -> Float[np.ndarray, "rows columns 3"]:
    return np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1)


def _noise_at(points: Float[np.ndarray, "rows columns 3"], scale: float, offset: float) -> Field:
    """Periodic noise read trilinearly; `scale` is periods per Earth radius."""
    from scipy.ndimage import map_coordinates

    cells = np.moveaxis((points * scale + offset) * SIZE, -1, 0)
    return map_coordinates(fractal(), cells, order=1, mode="grid-wrap")


def _stream(where: Float[np.ndarray, "rows columns 3"]) -> Field:
    """Smooth stream function: plane waves in space cut by the sphere, eddies from 7000 km down to 1300 km."""
    rng = np.random.default_rng(11)
    psi = np.zeros(where.shape[:2])
    for k in np.geomspace(5.0, 30.0, 48):
        direction = rng.normal(size=3)
        wave = where @ (k * direction / np.linalg.norm(direction)) + rng.uniform(0.0, 2.0 * np.pi)
        psi += 2.6 * k**-1.9 / np.sqrt(24.0) * np.cos(wave)
    return psi


def _flow(lon: Field, lat: Field) -> tuple[Field, Field]:
    """Angular velocities (east / cos(lat), north) [rad per unit time] of a non-divergent flow."""
    tracks = np.exp(-(((np.abs(lat) - 0.85) / 0.40) ** 2))
    psi = _stream(_on_sphere(lon, lat)) * (0.45 + tracks)
    d = np.pi / ROWS
    d_north = -np.gradient(psi, d, axis=0)
    d_east = (np.roll(psi, -1, axis=1) - np.roll(psi, 1, axis=1)) / (2.0 * d)
    cos = np.maximum(np.cos(lat), 0.15)
    jets = 0.5 * tracks - 0.25 * np.exp(-((lat / 0.3) ** 2))
    return (-d_north + jets) / cos, d_east / cos


def _traced(steps: int = 50, dt: float = 0.015) -> tuple[Field, Field]:
    """Longitude and latitude from which the air at each grid point came."""
    import cv2

    lon, lat = _grid()
    u, v = (part.astype(np.float32) for part in _flow(lon, lat))
    for _ in range(steps):
        column = ((lon + np.pi) / (2.0 * np.pi) * COLUMNS - 0.5).astype(np.float32)
        row = ((np.pi / 2.0 - lat) / np.pi * ROWS - 0.5).astype(np.float32)
        du = cv2.remap(u, column, row, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
        dv = cv2.remap(v, column, row, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        lon, lat = lon - dt * du, np.clip(lat - dt * dv, -1.55, 1.55)
    return lon, lat


def _climate(lat: Field) -> Field:
    """Departure of the cloud rank by latitude: tropical rain belt, dry subtropics, grey storm tracks."""
    degrees = np.degrees(lat)
    belt = 0.16 * np.exp(-(((degrees - 5.0) / 7.0) ** 2))
    dry = -0.15 * np.exp(-(((np.abs(degrees) - 22.0) / 9.0) ** 2))
    tracks = 0.20 * np.exp(-(((np.abs(degrees) - 58.0) / 16.0) ** 2))
    return belt + dry + tracks


def _make() -> Float32[np.ndarray, "rows columns"]:
    lon, lat = _traced()
    where = _on_sphere(lon, lat) * np.array([1.0, 1.0, 1.6])
    moisture = _noise_at(where, 0.22, 0.1) + 0.55 * _noise_at(where, 0.8, 0.5) + 0.25 * _noise_at(where, 2.6, 0.9)
    rank = moisture / moisture.std() * 0.29 + _climate(_grid()[1])
    return _equalised(rank)


def _equalised(field: Field) -> Float32[np.ndarray, "rows columns"]:
    """Monotone map to [0, 1] that makes every value equally frequent over the sphere."""
    weight = np.cos(_grid()[1]).ravel()
    order = np.argsort(field.ravel(), kind="stable")
    rank = np.empty(field.size)
    rank[order] = np.cumsum(weight[order])
    return (rank / rank.max()).reshape(field.shape).astype(np.float32)
