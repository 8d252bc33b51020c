"""What a source says: an image came, the source went away or is back."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from threading import Event
from typing import Protocol

from proxnav.geometry.types import Image


@dataclass(frozen=True, slots=True)
class Arrival:
    """An image that came; it is decoded when somebody wants it."""

    name: str
    t: float
    """When it was taken [s]: since 1970, since the video began, or as its name says."""
    came: float
    """When the source had it, by the clock of `time.monotonic` [s]."""
    load: Callable[[], Image]
    """Decodes it; InputError where it is empty, truncated or no image."""


@dataclass(frozen=True, slots=True)
class Gone:
    """The source went away: a folder removed, a camera unplugged."""

    why: str


@dataclass(frozen=True, slots=True)
class Back:
    """The source is there again."""


Heard = Arrival | Gone | Back


class Source(Protocol):
    """Something that images come from."""

    def heard(self, stop: Event) -> Iterator[Heard | None]:
        """What is heard until the source ends or `stop` is set; None where nothing came for a moment."""
        ...
