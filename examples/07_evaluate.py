"""How good are the poses? Estimates of any origin, as SPEED+ style records, against the truth."""

from pathlib import Path

import numpy as np

import proxnav as pn
from proxnav.datasets.formats.speed_poses import PoseRecord, read_poses, write_poses
from proxnav.evaluation.consistency import consistency
from proxnav.evaluation.error_tables import consistency_line, table1
from proxnav.evaluation.pairing import pair
from proxnav.evaluation.summary import summarise_frames
from proxnav.targets.loading import load_target
from proxnav.trajectories import ShellConfig, random_shell
from proxnav.viewing.plots import errors_by_range


def estimate(T_true: pn.Pose, points_m: np.ndarray, camera: pn.Camera, rng: np.random.Generator) -> pn.PoseResult:
    """A stand-in for a detector: true keypoints with one pixel of noise."""
    pixels = camera.project(T_true @ points_m) + rng.normal(size=(len(points_m), 2))
    return pn.estimate_pose(points_m, pixels, camera, covariances_px2=np.tile(np.eye(2), (len(points_m), 1, 1)))


def main(out: Path = Path("out/examples"), frames: int = 200) -> float:
    """Writes poses.json and truth.json, reads them as any tool's files, and prints the study's table beside ours."""
    camera = pn.Camera(width=1024, height=1024, fx=1407.0, fy=1407.0, cx=512.0, cy=512.0)
    points_m, rng = load_target("space-rider").keypoints_m, np.random.default_rng(0)
    views = random_shell(ShellConfig(count=frames))
    truth = [PoseRecord(f"{k:04d}.png", views.T_cam_target(k), "truth") for k in range(frames)]
    results = [estimate(views.T_cam_target(k), points_m, camera, rng) for k in range(frames)]
    found = [
        PoseRecord(record.filename, result.T_cam_target, result.status, result.covariance)
        for record, result in zip(truth, results, strict=True)
    ]
    write_poses(out / "poses.json", found)
    write_poses(out / "truth.json", truth)

    pairs = pair(read_poses(out / "poses.json"), read_poses(out / "truth.json"))
    summary = summarise_frames(pairs)
    print(f"{table1(summary)}\n\n{consistency_line(consistency(pairs))}")
    posed = [(frame.range_m, e.e_t_norm_m, e.e_r_rad) for frame in pairs if (e := frame.errors) is not None]
    errors_by_range(*np.array(posed).T).savefig(out / "07_evaluate.png", dpi=100)
    print(f"\nerrors against range in {out / '07_evaluate.png'}")
    return summary.mean_e_c


if __name__ == "__main__":
    main()
