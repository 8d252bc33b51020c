"""The loop: a thread hears the source, the newest images wait in a short queue, each is answered and told on."""

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.types import Image
from proxnav.live.stream.answers import Answer, Tally
from proxnav.live.stream.arrivals import Arrival, Back, Gone, Heard, Source
from proxnav.live.stream.newest import NewestQueue
from proxnav.records import NavState, PoseResult

Frames = Literal["newest", "all"]
"""newest: when images come faster than they are answered, old ones are dropped; all: the source waits."""
Estimate = Callable[[Image, Camera, float], PoseResult]
"""Pose of an image of a camera, taken at t [s]."""
Fuse = Callable[[float, PoseResult], NavState | None]
"""State of a filter after the pose of an image taken at t [s]."""
Tell = Callable[[Answer, Image], None]
"""Gets each answer with its image."""


def no_filter(t: float, result: PoseResult) -> NavState | None:
    """Fuses nothing."""
    del t, result
    return None


@dataclass(frozen=True, slots=True)
class Loop:
    """From arrivals to answers."""

    camera: Camera
    estimate: Estimate
    tells: Sequence[Tell]
    say: Callable[[str], None]
    """Hears a sentence for each thing that went wrong."""
    fuse: Fuse = no_filter
    frames: Frames = "newest"
    waiting: int = 2
    """Images that may wait."""

    def run(self, source: Source, tally: Tally, is_stopped: Callable[[], bool] = lambda: False) -> None:
        """Answers until the source ends or `is_stopped`, counting into `tally`; the answer in hand is finished."""
        stop, queue, failed = threading.Event(), NewestQueue[Heard](self.waiting), list[BaseException]()
        hearing = threading.Thread(target=self._hear, args=(source, queue, stop, failed), daemon=True)
        hearing.start()
        newest = -float("inf")
        try:
            while (heard := queue.take(is_stopped)) is not None:
                tally.refused["dropped"] = queue.dropped
                newest = self._answer(heard, newest, tally)
        finally:
            stop.set()
            tally.refused["dropped"] = queue.dropped
            hearing.join(timeout=2.0)
        if failed:
            raise failed[0]

    def _hear(
        self, source: Source, queue: NewestQueue[Heard], stop: threading.Event, failed: list[BaseException]
    ) -> None:
        """Puts what the source says into the queue; what makes it fail is raised where the answers are made."""
        try:
            for heard in source.heard(stop):
                if heard is None:
                    continue
                if self.frames == "newest" and isinstance(heard, Arrival):
                    queue.put(heard)
                else:
                    queue.put_when_free(heard, stop)
        except BaseException as error:
            failed.append(error)
        finally:
            queue.close()

    def _answer(self, heard: Heard, newest: float, tally: Tally) -> float:
        """Answers one arrival; the time of the newest image that was looked at."""
        if isinstance(heard, Gone | Back):
            self._note(heard, tally)
            return newest
        try:
            image = heard.load()
        except InputError as error:
            tally.refused[_kind(str(error))] += 1
            self.say(str(error))
            return newest
        if not heard.t > newest:
            tally.refused["stale"] += 1
            self.say(f"{heard.name}: not newer than the image before it (t = {heard.t:.3f} s); left out")
            return newest
        if image.shape[:2] != (self.camera.height, self.camera.width):
            tally.refused["wrong size"] += 1
            height, width = image.shape[:2]
            self.say(f"{heard.name}: {width}x{height} px, the camera has {self.camera.width}x{self.camera.height} px")
            return newest
        result = self.estimate(image, self.camera, heard.t)
        answer = Answer(heard.name, heard.t, result, time.monotonic() - heard.came, self.fuse(heard.t, result))
        tally.answered(answer)
        for tell in self.tells:
            tell(answer, image)
        return heard.t

    def _note(self, heard: Gone | Back, tally: Tally) -> None:
        """The source went away or is back."""
        if isinstance(heard, Gone):
            tally.losses += 1
            self.say(f"the source is gone ({heard.why}); waiting for it")
        else:
            tally.returns += 1
            self.say("the source is back")


def _kind(error: str) -> str:
    """One word for what is wrong with a file."""
    return next((kind for kind in ("empty", "truncated") if error.endswith(kind)), "unreadable")
