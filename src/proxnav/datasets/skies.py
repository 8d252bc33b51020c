"""Where Sun and Earth stand in each image: a csv as star tracker and ephemeris give it, or a data set's scenes."""

from pathlib import Path

import numpy as np

from proxnav.datasets.set.dataset import Dataset
from proxnav.errors import InputError
from proxnav.geometry.types import Vector3
from proxnav.records import SceneSpec, Sky
from proxnav.storage.tables import read_rows

NAME, SUN, NADIR = "filename", ("sun_x", "sun_y", "sun_z"), ("nadir_x", "nadir_y", "nadir_z")
"""Columns of the csv: directions in camera axes, of any length; the nadir may be left out."""


def read_skies(source: Path) -> dict[str, Sky]:
    """Sky by file name, from a csv or from a data set whose scenes say it; InputError for what is neither."""
    if source.is_dir():
        return {scene.filename: sky_of(scene) for scene in Dataset(source).scenes()}
    header, *rows = read_rows(source)
    missing = [column for column in (NAME, *SUN) if column not in header]
    if missing:
        raise InputError(f"{source}: needs the columns {NAME}, {', '.join(SUN)}, found {', '.join(header)[:120]}")
    skies = (_row(dict(zip(header, row, strict=False)), f"{source}, row {k}") for k, row in enumerate(rows, 2))
    return dict(skies)


def sky_of(scene: SceneSpec) -> Sky:
    """What a craft with a star tracker and an ephemeris would know of a drawn scene."""
    R = scene.T_cam_target.R
    nadir = None if scene.earth is None else R @ np.array(scene.earth.r_target_earth_m)
    return Sky(R @ np.array(scene.sun.direction_target), nadir, scene.sun.visible_fraction)


def _row(cells: dict[str, str], where: str) -> tuple[str, Sky]:
    has_nadir = all(cells.get(column) for column in NADIR)
    nadir = _direction(cells, NADIR, where) if has_nadir else None
    return cells[NAME], Sky(_direction(cells, SUN, where), nadir)


def _direction(cells: dict[str, str], columns: tuple[str, ...], where: str) -> Vector3:
    try:
        vector = np.array([float(cells[column]) for column in columns])
    except (KeyError, ValueError):
        raise InputError(f"{where}: {', '.join(columns)} must be three numbers") from None
    if not np.isfinite(vector).all() or not np.linalg.norm(vector) > 0.0:
        raise InputError(f"{where}: {', '.join(columns)} must be a direction, found {vector.tolist()}")
    return vector
