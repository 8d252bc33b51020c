"""Frames from outside, judged as they arrive: what cannot be used is counted by its fault and survived."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, get_args

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.types import Image

FrameFault = Literal["empty", "damaged", "other_size", "repeated", "out_of_order", "stale"]
"""empty: no bytes; damaged: not decodable; other_size: not of the camera's size; repeated: the stamp of the frame
before; out_of_order: an earlier stamp; stale: taken too long ago."""
FAULTS: tuple[FrameFault, ...] = get_args(FrameFault)
RESTARTED_AFTER = 3
"""So many frames out of order, but in order among themselves, are a source whose clock began anew."""


@dataclass(slots=True)
class FrameIntake:
    """Counts of the frames that arrived, by what became of them."""

    oldest_s: float = float("inf")
    """Age from which on a frame is stale."""
    used: int = 0
    faults: Counter[FrameFault] = field(default_factory=Counter)
    restarts: int = 0
    """How often the source's clock began anew."""
    reason: str = ""
    """What was wrong with the last frame that was left out, for people."""
    _last: float = float("-inf")
    _behind: list[float] = field(default_factory=list)

    @property
    def arrived(self) -> int:
        """All frames, used or not."""
        return self.used + self.faults.total()

    def take(self, t: float, now: float, camera: Camera, decode: Callable[[], Image | None]) -> Image | None:
        """The image of the frame taken at `t` [s]; None where it is left out, which is counted.

        `now` [s] is by the same clock; `decode` gives None for an empty frame and raises InputError for a damaged one.
        """
        fault = self._fault_of_time(t, now)
        if fault is not None:
            return self._left_out(fault, f"taken at {t:.3f} s, the one before at {self._last:.3f} s, now {now:.3f} s")
        try:
            image = decode()
        except InputError as error:
            return self._left_out("damaged", str(error))
        if image is None:
            return self._left_out("empty", "the message holds no bytes")
        height, width = image.shape[:2]
        if (width, height) != (camera.width, camera.height):
            return self._left_out("other_size", f"{width}x{height} px of a camera of {camera.width}x{camera.height} px")
        self._last = t
        self.used += 1
        return image

    def summary(self) -> str:
        """Counts in one line."""
        left = ", ".join(f"{self.faults[fault]} {fault}" for fault in FAULTS if self.faults[fault])
        return f"{self.used} of {self.arrived} frames used" + (f"; left out: {left}" if left else "")

    def _fault_of_time(self, t: float, now: float) -> FrameFault | None:
        if now - t > self.oldest_s:
            return "stale"
        if t > self._last:
            self._behind.clear()
            return None
        if t == self._last:
            return "repeated"
        if self._behind and t <= self._behind[-1]:
            self._behind.clear()
        self._behind.append(t)
        if len(self._behind) < RESTARTED_AFTER:
            return "out_of_order"
        self._behind.clear()
        self._last = float("-inf")
        self.restarts += 1
        return None

    def _left_out(self, fault: FrameFault, reason: str) -> None:
        self.faults[fault] += 1
        self.reason = f"{fault}: {reason}"
