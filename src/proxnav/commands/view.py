"""`proxnav view`: replay of any run, in Rerun's viewer or as a file to send."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


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
    """Opens the replay, or saves it."""
    from proxnav.errors import InputError
    from proxnav.storage.files import check_new_file
    from proxnav.viewing.replay.of_run import read_replay
    from proxnav.viewing.replay.rerun_recording import open_rerun
    from proxnav.viewing.replay.save import writer_of

    if config.every < 1:
        raise InputError(f"--every {config.every}: expected 1 or more")
    if config.save is None:
        open_rerun(read_replay(config.run, config.target, config.every))
        return
    write = writer_of(config.save, config.fps, config.size)
    check_new_file(config.save)
    replay = read_replay(config.run, config.target, config.every)
    write(replay)
    print(f"{len(replay.steps)} steps in {config.save}")
