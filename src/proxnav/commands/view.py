"""`proxnav view`: replay of any run, in Rerun's viewer or as a file to send."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from proxnav.errors import InputError


@dataclass(frozen=True)
class ViewConfig:
    """Plays a run folder of `demo`, `benchmark table1` or `navigate` in the Rerun viewer, or writes it to a file.

    One time line: camera frustum and image with keypoints, target mesh, trajectory, 3-sigma ellipsoids, error plots.
    """

    run: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RUN")]
    """Folder with frames.json (demo, benchmark table1) or solution.csv (navigate)."""
    save: Path | None = None
    """Write here and open nothing: .rrd (Rerun), .mp4 (video with overlay) or .mcap (ROS 2 messages, for Foxglove)."""
    target: str | None = None
    """Name or file of the target whose mesh is shown; the run's own when not given."""
    every: Annotated[int, tyro.conf.arg(metavar="N")] = 1
    """Take each N-th step only."""
    fps: float = 10.0
    """Video: steps shown per second [1/s]."""
    size: int = 1024
    """Video: longer side of the picture [px]."""


def run(config: ViewConfig) -> None:
    """Entry of `proxnav view`."""
    if config.every < 1:
        raise InputError(f"--every {config.every}: expected 1 or more")
    from proxnav.storage.files import check_new_file
    from proxnav.viewing.replay.of_run import read_replay

    write = None if config.save is None else _writer(config)
    if config.save is not None:
        check_new_file(config.save)
    replay = read_replay(config.run, config.target, config.every)
    if write is None:
        from proxnav.viewing.replay.rerun_recording import open_rerun

        open_rerun(replay)
        return
    write(replay)
    print(f"{len(replay.steps)} steps in {config.save}")


def _writer(config: ViewConfig) -> Callable:
    """What writes the kind of file that the name ends with."""
    from proxnav.viewing.replay.mcap_export import save_mcap
    from proxnav.viewing.replay.rerun_recording import save_rerun
    from proxnav.viewing.replay.video import save_video

    path = config.save
    assert path is not None
    kinds: dict[str, Callable] = {
        ".rrd": lambda replay: save_rerun(replay, path),
        ".mp4": lambda replay: save_video(replay, path, config.fps, config.size),
        ".mcap": lambda replay: save_mcap(replay, path),
    }
    if path.suffix.lower() not in kinds:
        raise InputError(f"--save {path}: the name says what to write; end it with {', '.join(kinds)}")
    return kinds[path.suffix.lower()]
