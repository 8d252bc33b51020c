"""Alignment alone on photographs with true poses: started at the truth disturbed, where does it end?

    python tools/align_photographs.py LABELS.json IMAGES [MORE_IMAGES ...] --camera camera.json [--target tango]

Each image is started `--starts` times at its true pose, turned and moved by normal errors of `--turn-deg` and
`--shift` (over the range) in all three axes together. Prints a row for each image and the medians of all starts.
"""

import argparse
import zlib
from pathlib import Path

import numpy as np
from jaxtyping import Float

from proxnav.datasets.formats.speed_poses import read_poses
from proxnav.geometry import Camera, Pose
from proxnav.geometry.perturbation import moved
from proxnav.geometry.pose_errors import pose_errors
from proxnav.geometry.types import GreyImage
from proxnav.images.codecs import read_image
from proxnav.images.tones import grey_8_bit
from proxnav.pose.align import Prior, align
from proxnav.targets.loading import load_target
from proxnav.targets.target import Target


def main() -> None:
    """Prints a row for each image and the medians."""
    options = _parser().parse_args()
    camera, target = Camera.read(options.camera), load_target(options.target)
    print("image              range [m]  E_R before -> after [deg] (share of the outline on edges)")
    found = []
    for name, record in read_poses(options.labels).items():
        path = next((folder / name for folder in options.images if (folder / name).is_file()), None)
        if path is None or record.T_cam_target is None:
            continue
        grey, T_true = grey_8_bit(read_image(path)), record.T_cam_target
        sigma = _sigma(T_true, options.turn_deg, options.shift)
        rng = np.random.default_rng(zlib.crc32(name.encode()))
        starts = [T_true if options.at_truth else _disturbed(T_true, sigma, rng) for _ in range(options.starts)]
        rows = [_row(grey, camera, target, T_true, start, sigma) for start in starts]
        print(f"{name:18s} {np.linalg.norm(T_true.t_m):9.2f}  " + "  ".join(map(_cell, rows)), flush=True)
        found += rows
    if not found:
        raise SystemExit(f"{options.labels}: names no image of {', '.join(map(str, options.images))}")
    print(_medians(np.array(found)))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("labels", type=Path)
    parser.add_argument("images", type=Path, nargs="+")
    parser.add_argument("--camera", type=Path, required=True)
    parser.add_argument("--target", default="tango")
    parser.add_argument("--starts", type=int, default=3)
    parser.add_argument("--turn-deg", type=float, default=5.0)
    parser.add_argument("--shift", type=float, default=0.03)
    parser.add_argument("--at-truth", action="store_true", help="start at the truth, as unsure as otherwise")
    return parser


def _sigma(T_true: Pose, turn_deg: float, shift: float) -> Float[np.ndarray, "6"]:
    """Standard deviations of (dt [m], dr [rad]) along each axis."""
    along = shift * np.linalg.norm(T_true.t_m) / np.sqrt(3.0)
    return np.concatenate([np.full(3, along), np.full(3, np.radians(turn_deg) / np.sqrt(3.0))])


def _disturbed(T_true: Pose, sigma: Float[np.ndarray, "6"], rng: np.random.Generator) -> Pose:
    return moved(T_true, sigma * rng.standard_normal(6))


def _row(
    grey: GreyImage, camera: Camera, target: Target, T_true: Pose, start: Pose, sigma: Float[np.ndarray, "6"]
) -> tuple[float, float, float, float, float]:
    """E_R [deg] before and after, E_C before and after, share on edges; a refused alignment stays where it was."""
    found = align(grey, camera, target, Prior.of(start, np.diag(sigma**2)))
    before = pose_errors(start, T_true)
    after = before if found is None else pose_errors(found.T_cam_target, T_true)
    share = 0.0 if found is None else found.edge_share
    return float(np.degrees(before.e_r_rad)), float(np.degrees(after.e_r_rad)), before.e_c, after.e_c, share


def _cell(row: tuple[float, float, float, float, float]) -> str:
    return f"{row[0]:4.1f} ->{row[1]:5.1f} ({row[4]:.2f})"


def _medians(rows: Float[np.ndarray, "n 5"]) -> str:
    a, b, c, d, share = np.median(rows, axis=0)
    better = 100.0 * (rows[:, 1] < rows[:, 0]).mean()
    return (
        f"medians of {len(rows)}: E_R {a:.2f} -> {b:.2f} deg, E_C {c:.4f} -> {d:.4f}, {better:.0f} % improved, "
        f"share on edges {share:.2f}"
    )


if __name__ == "__main__":
    main()
