"""STK ephemeris files (.e). Defaults as in STK: metres, Earth-fixed axes, Lagrange through 6 points."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from proxnav.geometry.celestial import EARTH_EQUATORIAL_RADIUS, EARTH_FLATTENING, geodetic_to_ecef
from proxnav.geometry.types import Vector3
from proxnav.trajectories.readers.history import Method, OrbitHistory, Segment, Series, split
from proxnav.trajectories.readers.reference_frames import ReferenceFrame
from proxnav.trajectories.readers.stk_file import Row, StkFile, data_rows, read_stk, reference_frame, scenario_epoch
from proxnav.trajectories.readers.text import check_times, fail, number, numbers
from proxnav.trajectories.readers.units import LENGTH

_COLUMNS = {
    "ephemeristimepos": 4,
    "ephemeristimeposvel": 7,
    "ephemeristimeposvelacc": 10,
    "ephemerisllatimepos": 4,
    "ephemerisllatimeposvel": 7,
}
_METHODS: dict[str, Method] = {"lagrange": "lagrange", "hermite": "hermite", "lagrangevop": "lagrange"}


def read_stk_ephemeris(path: str | Path) -> OrbitHistory:
    """Positions [m] and velocities as the file declares them."""
    file = read_stk(path, "ephemeris", set(_COLUMNS))
    block, rows = data_rows(file, set(_COLUMNS), "numberofephemerispoints")
    values = np.array([numbers(row.tokens, _COLUMNS[block], path, row.line, f"a row of {block}") for row in rows])
    check_times(values[:, 0].tolist(), [row.line for row in rows], path)
    r, v = _states(file, block, values[:, 1:])
    pieces = split(values[:, 0], _boundaries(file))
    segments = tuple(Segment(values[p, 0], r[p], None if v is None else v[p]) for p in pieces)
    frame = ReferenceFrame("ecef") if "lla" in block else reference_frame(file, "coordinatesystem", "Fixed")
    unused = any(name.startswith("covariance") for name in file.blocks)
    note = "its covariance block is not used" if unused else ""
    method, epoch = _method(file), scenario_epoch(file)
    return OrbitHistory(Path(path).stem, str(path), epoch, frame, segments, method, _nodes(file), note)


def _states(file: StkFile, block: str, values: Float[np.ndarray, "n k"]) -> tuple[Vector3, Vector3 | None]:
    scale = _distance_unit(file)
    if "lla" not in block:
        return scale * values[:, :3], scale * values[:, 3:6] if "vel" in block else None
    latitude, longitude = np.deg2rad(values[:, 0]), np.deg2rad(values[:, 1])
    r = geodetic_to_ecef(latitude, longitude, scale * values[:, 2])
    if "vel" not in block:
        return r, None
    rates = values[:, 3:6] * [np.pi / 180.0, np.pi / 180.0, scale]
    return r, _geodetic_velocity(latitude, longitude, scale * values[:, 2], rates)


def _geodetic_velocity(latitude: Series, longitude: Series, altitude: Series, rates: Vector3) -> Vector3:
    """Earth-fixed velocity of geodetic rates: east, north and up by the ellipsoid's radii of curvature."""
    e2 = EARTH_FLATTENING * (2.0 - EARTH_FLATTENING)
    w = 1.0 - e2 * np.sin(latitude) ** 2
    N = EARTH_EQUATORIAL_RADIUS / np.sqrt(w)
    M = N * (1.0 - e2) / w
    north, east, up = (M + altitude) * rates[:, 0], (N + altitude) * np.cos(latitude) * rates[:, 1], rates[:, 2]
    sp, cp, sl, cl = np.sin(latitude), np.cos(latitude), np.sin(longitude), np.cos(longitude)
    x = -sl * east - sp * cl * north + cp * cl * up
    y = cl * east - sp * sl * north + cp * sl * up
    return np.stack([x, y, cp * north + sp * up], axis=-1)


def _distance_unit(file: StkFile) -> float:
    line, name = file.keywords.get("distanceunit", (0, "meters"))
    if name.lower() not in LENGTH:
        fail(file.path, line, f"unknown DistanceUnit '{name}'; use Meters or Kilometers")
    return LENGTH[name.lower()]


def _method(file: StkFile) -> Method:
    line, name = file.keywords.get("interpolationmethod", (0, "Lagrange"))
    if name.lower() not in _METHODS:
        fail(file.path, line, f"unknown InterpolationMethod '{name}'; use Lagrange or Hermite")
    return _METHODS[name.lower()]


def _nodes(file: StkFile) -> int:
    older = file.integer("interpolationorder", 5)
    return file.integer("interpolationsamplesm1", older) + 1


def _boundaries(file: StkFile) -> Float[np.ndarray, "n_boundaries"]:
    """Times at which segments end, from the SegmentBoundaryTimes block; one or several in a line."""
    rows: list[Row] = file.blocks.get("segmentboundarytimes", [])
    times = [number(token, file.path, row.line, "a boundary time") for row in rows for token in row.tokens]
    return np.array(times, dtype=np.float64)
