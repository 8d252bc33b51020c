"""The closed loop in Basilisk: one flight, its run folder, and what it came to, as docs/benchmarks/live.md quotes it.

python tools/servicing_loop.py --out out/servicing                                     # images, 30 min, a held target
python tools/servicing_loop.py --out out/truth --loop.poses true                       # the same with true poses
python tools/servicing_loop.py --out out/tumbling --loop.serviced.tumble-deg-s 0.3 0.4 0.2
"""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import tyro

from proxnav.benchmarks.servicing_flight import FRAME_S
from proxnav.benchmarks.servicing_loop import LoopConfig, fly_loop
from proxnav.cli.progress import progress
from proxnav.storage.files import write_json


@dataclass(frozen=True)
class Options:
    """One flight."""

    out: Path
    """Run folder: records, truth.csv, solution.csv, camera.json, summary.json."""
    loop: LoopConfig = field(default_factory=LoopConfig)


def main(options: Options) -> None:
    """Flies and writes."""
    with progress("servicing", len(np.arange(0.0, options.loop.seconds, FRAME_S)) + 1) as done:
        run = fly_loop(options.loop, options.out, done)
    write_json(options.out / "summary.json", run.summary, indent=1)
    print({name: value for name, value in run.summary.items() if name not in ("options", "versions")})


if __name__ == "__main__":
    main(tyro.cli(Options))
