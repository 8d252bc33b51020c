"""Time of each trunk's crop network, one crop, by the runtime that `auto` takes; untrained weights cost the same.

python tools/trunk_speed.py [--side 192] [--rounds 60]
"""

import argparse
import tempfile
import time
from pathlib import Path
from typing import get_args

import numpy as np

from proxnav.detection.heatmap.config import HeatmapNetConfig, Trunk
from proxnav.detection.heatmap.export import ReadKeypoints, export
from proxnav.detection.heatmap.network import HeatmapNet
from proxnav.detection.sessions import open_session


def main() -> None:
    """Prints a line a trunk; rounds go through all trunks in turn, so that a busy machine is as unfair to each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--side", type=int, default=192)
    parser.add_argument("--rounds", type=int, default=60)
    options = parser.parse_args()
    crop = np.random.default_rng(1).random((1, options.side, options.side), dtype=np.float32)
    with tempfile.TemporaryDirectory() as folder:
        sessions, size = {}, {}
        for trunk in get_args(Trunk):
            net = HeatmapNet(HeatmapNetConfig(trunk), 24).eval()
            export(ReadKeypoints(net), ReadKeypoints.OUTPUTS, options.side, Path(folder), trunk)
            sessions[trunk] = open_session(Path(folder) / f"{trunk}.onnx")
            size[trunk] = sum(p.numel() for p in net.parameters()) / 1e6
        took = {trunk: [] for trunk in sessions}
        for _ in range(options.rounds):
            for trunk, session in sessions.items():
                start = time.perf_counter()
                session(crop)
                took[trunk].append(1e3 * (time.perf_counter() - start))
    for trunk, ms in took.items():
        print(f"{trunk}: {size[trunk]:.1f} M parameters, fastest {min(ms):.2f} ms, median {np.median(ms):.2f} ms")


if __name__ == "__main__":
    main()
