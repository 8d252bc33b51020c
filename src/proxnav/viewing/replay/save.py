"""A replay as a file of the kind that its name asks for."""

from collections.abc import Callable
from pathlib import Path

from proxnav.errors import InputError
from proxnav.viewing.replay.mcap_export import save_mcap
from proxnav.viewing.replay.replay import Replay
from proxnav.viewing.replay.rerun_recording import save_rerun
from proxnav.viewing.replay.video import save_video


def writer_of(path: Path, frames_per_s: float, side: int) -> Callable[[Replay], None]:
    """What writes a replay to .rrd (Rerun), .mp4 (video) or .mcap (ROS 2 messages); InputError for another ending."""
    kinds: dict[str, Callable[[Replay], None]] = {
        ".rrd": lambda replay: save_rerun(replay, path),
        ".mp4": lambda replay: save_video(replay, path, frames_per_s, side),
        ".mcap": lambda replay: save_mcap(replay, path),
    }
    if path.suffix.lower() not in kinds:
        raise InputError(f"--save {path}: the name says what to write; end it with {', '.join(kinds)}")
    return kinds[path.suffix.lower()]
