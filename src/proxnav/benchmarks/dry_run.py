"""`render --dry-run`: a few frames are rendered in a temporary folder, timed, and scaled up."""

import os
import time
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from proxnav.cluster.forecast import Forecast, folder_bytes
from proxnav.frames import FrameConfig
from proxnav.records import SceneSpec
from proxnav.rendered_set import render

_FRAMES = 3


def rendering_dry_run(scenes: Sequence[SceneSpec], config: FrameConfig, workers: int) -> str:
    """What rendering would take: three frames are rendered and written; the first starts the renderer, once."""
    few, times = list(scenes[:_FRAMES]), [time.perf_counter()]
    with TemporaryDirectory() as folder:
        render(few, config, Path(folder) / "set", 1, lambda: times.append(time.perf_counter()))
        written = folder_bytes(Path(folder)) / len(few)
    first = times[1] - times[0]
    each = (times[-1] - times[1]) / (len(few) - 1) if len(few) > 1 else first
    lanes = min(workers, os.cpu_count() or 1) if config.renderer == "raycast" else 1
    return Forecast(first + each * (len(scenes) - 1) / lanes, written * len(scenes)).text(f"{len(scenes)} frames")
