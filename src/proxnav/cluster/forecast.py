"""What a job would take, measured on a little of it: time and disk, in words."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Forecast:
    """What a job would take on this machine, as loaded as it is now."""

    seconds: float
    size_bytes: float

    def text(self, job: str) -> str:
        """One line for people."""
        return f"dry run: {job} would take about {duration(self.seconds)} and {size(self.size_bytes)} of disk here"


def duration(seconds: float) -> str:
    """Two digits in a unit that people use.

    >>> duration(42.0), duration(1500.0), duration(90_000.0)
    ('42 s', '25 min', '25 h')
    """
    value, unit = (seconds, "s") if seconds < 100 else (seconds / 60, "min")
    value, unit = (value, unit) if seconds < 7200 else (seconds / 3600, "h")
    return f"{value:.1f} {unit}" if value < 9.5 else f"{value:.0f} {unit}"


def size(size_bytes: float) -> str:
    """Bytes as kB, MB or GB.

    >>> size(2.5e6), size(3e9)
    ('2.5 MB', '3.0 GB')
    """
    units = ((1e9, "GB"), (1e6, "MB"), (1e3, "kB"))
    value, unit = next((size_bytes / f, name) for f, name in units if size_bytes >= f or name == "kB")
    return f"{value:.1f} {unit}" if value < 9.5 else f"{value:.0f} {unit}"


def folder_bytes(folder: Path) -> int:
    """Bytes of all files below a folder."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
