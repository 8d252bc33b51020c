"""A contradiction that the monitor has found."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Finding:
    """A contradiction between sensors, and what explains it."""

    t: float
    """When it was found [s]."""
    kind: str
    """Which sensors."""
    cause: str
    """A clause for people."""
