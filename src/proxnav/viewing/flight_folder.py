"""A navigation run as values that can be shown: `solution.csv` of `proxnav navigate`, errors where truth is known."""

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from proxnav.errors import InputError

MAX_BYTES = 512 * 2**20
SOLUTION = "solution.csv"


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """A csv of numbers."""

    path: Path
    columns: dict[str, np.ndarray]
    """(n,) by name; NaN where a cell is no number."""
    status: tuple[str, ...]
    """(n,) texts of the column `status`; empty strings without one."""

    def block(self, *names: str) -> np.ndarray:
        """(n, len(names)) of finite numbers; InputError names the column that is missing or holds something else."""
        for name in names:
            if name not in self.columns or not np.isfinite(self.columns[name]).all():
                raise InputError(f"{self.path}: column {name} is missing or holds something that is no finite number")
        return np.stack([self.columns[name] for name in names], axis=1)

    def column(self, name: str) -> np.ndarray:
        """(n,) of finite numbers."""
        return self.block(name)[:, 0]


@dataclass(frozen=True, slots=True, eq=False)
class Flight:
    """n instants of a navigation solution; errors are true less estimated, NaN where unknown."""

    t: np.ndarray
    status: tuple[str, ...]
    r_ric_m: np.ndarray
    """(n, 3) camera in the target's RIC frame."""
    q_cam_target: np.ndarray
    sigma: np.ndarray
    """(n, 6) standard deviations of RIC position [m] and of attitude [rad], target axes."""
    covariance_m2: np.ndarray
    """(n, 3, 3) of RIC position."""
    errors: np.ndarray
    """(n, 6)."""
    nees: np.ndarray
    """(n,) squared normalised error of the twelve states."""

    @property
    def has_truth(self) -> bool:
        """Whether errors are known."""
        return bool(np.isfinite(self.errors).any())


def read_flight(folder: Path) -> Flight:
    """The solution in a folder; InputError names what is missing."""
    table = read_table(folder / SOLUTION)
    n = len(table.status)
    missing = np.full(n, np.nan)
    position, attitude = [f"r_ric_{a}_m" for a in "xyz"], [f"theta_{a}_rad" for a in "xyz"]
    covariance = np.empty((n, 3, 3))
    for i in range(3):
        for j in range(i, 3):
            covariance[:, i, j] = covariance[:, j, i] = table.column(f"cov_{i}_{j}")
    return Flight(
        t=table.column("t_s"),
        status=table.status,
        r_ric_m=table.block(*position),
        q_cam_target=table.block(*(f"q_cam_target_{c}" for c in "wxyz")),
        sigma=table.block(*(f"sigma_{name}" for name in position + attitude)),
        covariance_m2=covariance,
        errors=np.stack([table.columns.get(f"error_{name}", missing) for name in position + attitude], axis=1),
        nees=table.columns.get("nees", missing),
    )


def read_table(path: Path) -> Table:
    """A csv with a header; a cell that is no number is NaN."""
    if not path.is_file():
        raise InputError(f"{path}: no such file; expected a csv that proxnav simulate or navigate writes")
    if path.stat().st_size > MAX_BYTES:
        raise InputError(f"{path}: larger than {MAX_BYTES // 2**20} MiB")
    try:
        with path.open(newline="", encoding="utf-8-sig", errors="replace") as file:
            rows = list(csv.reader(file))
    except csv.Error as error:
        raise InputError(f"{path}: not a csv file ({error})") from None
    header, body = (rows[0] if rows else []), rows[1:]
    if not body or any(len(row) != len(header) for row in body):
        raise InputError(f"{path}: expected a header and rows of as many cells; it is empty or cut short")
    found = dict(zip(header, zip(*body, strict=True), strict=True))
    status = tuple(found.pop("status", ("",) * len(body)))
    return Table(path, {name: np.array([_number(cell) for cell in cells]) for name, cells in found.items()}, status)


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return math.nan
