"""A video file or a camera device, read by OpenCV; a camera that goes away is opened again when it is back."""

import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from threading import Event

import cv2
import numpy as np

from proxnav.errors import InputError
from proxnav.geometry.types import Image
from proxnav.live.stream.arrivals import Arrival, Back, Gone, Heard

_AGAIN_S = 0.5
"""Between two trials to open a camera that is gone."""


@dataclass(frozen=True, slots=True)
class VideoSource:
    """Frames of a video file, at its own pace or as fast as they are taken; times count from its beginning."""

    path: Path
    in_real_time: bool
    """Whether a frame comes when the video shows it, ready or not."""

    def heard(self, stop: Event) -> Iterator[Heard | None]:
        """Each frame; ends with the video."""
        capture = _opened(str(self.path))
        rate = capture.get(cv2.CAP_PROP_FPS)
        rate = rate if 0.1 < rate < 1000.0 else 25.0
        begun, number = time.monotonic(), 0
        while not stop.is_set():
            there, picture = capture.read()
            if not there:
                break
            t = number / rate
            if self.in_real_time:
                stop.wait(max(0.0, begun + t - time.monotonic()))
            yield _arrival(f"{self.path.name}#{number}", t, picture)
            number += 1
        capture.release()


@dataclass(frozen=True, slots=True)
class CameraSource:
    """Frames of a camera device; times are seconds since 1970, when the frame was read."""

    device: int

    def heard(self, stop: Event) -> Iterator[Heard | None]:
        """Each frame; waits for a camera that went away."""
        capture, number = _opened(self.device), 0
        while not stop.is_set():
            there, picture = capture.read()
            if there:
                yield _arrival(f"camera{self.device}#{number}", time.time(), picture)
                number += 1
                continue
            capture.release()
            yield Gone(f"camera {self.device} gives no frames")
            while not capture.isOpened() and not stop.wait(_AGAIN_S):
                capture.open(self.device)
                yield None
            if capture.isOpened():
                yield Back()
        capture.release()


def _opened(what: str | int) -> cv2.VideoCapture:
    capture = cv2.VideoCapture(what)
    if not capture.isOpened():
        kind = "no camera with that number answers" if isinstance(what, int) else "no video that OpenCV can read"
        raise InputError(f"{what}: {kind}; give a folder, a video file or camera:NUMBER")
    return capture


def _arrival(name: str, t: float, picture: np.ndarray) -> Arrival:
    image: Image = np.ascontiguousarray(picture[..., 2::-1]) if picture.ndim == 3 else picture
    return Arrival(name, t, time.monotonic(), lambda: image)
