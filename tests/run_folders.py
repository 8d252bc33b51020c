"""Run folders with known errors, as the pipeline writes them."""

from pathlib import Path

import numpy as np

from proxnav.datasets.formats.speed_poses import PoseRecord, write_poses
from proxnav.evaluation.consistency import consistency
from proxnav.evaluation.metrics import metrics
from proxnav.evaluation.pairing import pair
from proxnav.evaluation.summary import summarise_frames
from proxnav.geometry import Pose, quaternion
from proxnav.images.codecs import encode_png
from proxnav.storage.files import write_atomic, write_json

SIGMA = np.array([0.02, 0.02, 0.2, 0.01, 0.01, 0.01])  # m, rad


def write_run_folder(folder: Path, rng: np.random.Generator, names: list[str], side: int, pictures: int) -> Path:
    """Frame 1 has no pose, frame 2 is a half turn, if there are."""
    truth = [PoseRecord(name, _true(rng), "truth") for name in names]
    estimates = [_estimate(k, record, rng) for k, record in enumerate(truth)]
    write_poses(folder / "poses.json", estimates)
    write_poses(folder / "truth.json", truth)
    pairs = pair({e.filename: e for e in estimates}, {t.filename: t for t in truth})
    write_json(folder / "metrics.json", metrics(summarise_frames(pairs), consistency(pairs)))
    for k in range(pictures):
        image = rng.integers(0, 256, (side, side, 3), dtype=np.uint8)
        write_atomic(folder / "overlays" / f"{('best', 'median', 'worst')[k % 3]}-{k:04d}.png", encode_png(image))
    return folder


def _true(rng: np.random.Generator) -> Pose:
    return Pose.from_wxyz("cam", "target", quaternion.random(rng, 1)[0], [*rng.normal(size=2), rng.uniform(10, 100)])


def _estimate(k: int, truth: PoseRecord, rng: np.random.Generator) -> PoseRecord:
    if k == 1:
        return PoseRecord(truth.filename, None, "no_consensus")
    T, error = truth.T_cam_target, SIGMA * rng.normal(size=6)
    assert T is not None
    turn = quaternion.exp(np.array([0.0, 0.0, 3.0]) if k == 2 else error[3:])
    T_est = Pose.from_wxyz("cam", "target", quaternion.multiply(turn, T.q_wxyz), T.t_m + error[:3])
    return PoseRecord(truth.filename, T_est, "ok", np.diag(SIGMA**2))
