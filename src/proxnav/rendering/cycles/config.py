"""What one may choose about Cycles."""

from dataclasses import dataclass
from typing import Literal

from proxnav.errors import InputError


@dataclass(frozen=True)
class CyclesConfig:
    """Quality against time, and how the Blender worker is watched. No denoiser: it would invent structure."""

    samples: int = 64
    """Paths per pixel."""
    bounces: int = 3
    """Reflections between surfaces of the target."""
    device: Literal["auto", "cpu"] = "auto"
    """auto uses the GPUs that Blender finds; frames of different devices differ in their noise."""
    threads: int = 0
    """CPU threads; 0 takes all."""
    memory_limit_mb: float = 4096.0
    """A worker that holds more after a frame is replaced before the next one."""
    frames_per_worker: int = 1000
    """A worker is replaced after so many, whatever it holds; a start costs two seconds."""
    timeout_s: float = 900.0
    """A worker that gives no frame in this time is replaced and the frame repeated."""
    attempts: int = 3
    """How often one frame is tried before the error is shown."""

    def __post_init__(self) -> None:
        counts = (self.samples, self.attempts, self.frames_per_worker)
        if min(counts) < 1 or self.bounces < 0 or self.threads < 0:
            raise InputError(
                f"Cycles needs samples, attempts and frames_per_worker >= 1, bounces and threads >= 0, found {self}"
            )
