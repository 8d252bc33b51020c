"""`proxnav live`: poses of images as they come: a folder that fills, a video, a camera."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from proxnav.cli.options import CameraOptions
from proxnav.live.stream.assemble import StreamOptions


@dataclass(frozen=True)
class LiveConfig(StreamOptions, CameraOptions):
    """Answers each image that comes with its pose, and with the filter's state where --records are given.

    When images come faster than they are answered the oldest are dropped and counted. Damaged, stale and wrong-size
    images are counted and said; a source that goes away is waited for. Ctrl-C ends it, with a summary.
    """

    source: Annotated[str, tyro.conf.Positional]
    """A folder that fills, a video file, or camera:NUMBER."""
    out: Path | None = None
    """File that grows: .jsonl, .csv or .mcap; JSON lines on the standard output when not given."""
    view_port: int | None = None
    """Serves a live view on this port, 9876 for one: watch it with `rerun URL`."""


def run(config: LiveConfig) -> None:
    """Runs until the source ends or somebody interrupts; then the summary."""
    import sys

    from proxnav.cli.progress import say_when_compiling
    from proxnav.live.stream.answers import Tally
    from proxnav.live.stream.assemble import assembled
    from proxnav.storage.interrupt import stop_requested

    camera = None if config.camera is None else config.camera_from(config.camera)
    say_when_compiling("pose")
    tally = Tally()
    with assembled(config.source, camera, config, config.out, config.view_port) as (loop, source):
        with stop_requested() as is_stopped:  # a raised interrupt would be lost in callbacks of compilers
            loop.run(source, tally, is_stopped)
        if is_stopped():
            print("proxnav live: interrupted", file=sys.stderr)
    print(tally.text(), file=sys.stderr if config.out is None else sys.stdout)
