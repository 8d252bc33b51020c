"""Measures whether pose covariances stay honest when the camera's intrinsics err by what is declared of them.

Keypoints of Space Rider with Gaussian noise are seen by a camera that errs by draws of `calibration_sigma`; the pose is
solved with the nominal camera. Honest covariances give a mean NEES of 6 for the 6 errors of a pose.

    python tools/calibration_honesty.py --frames 400
"""

import argparse
import json
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from proxnav.cli.main import main as proxnav
from proxnav.datasets.formats.speed_poses import read_poses
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.geometry.calibration import EXACT, CalibrationSigma
from proxnav.geometry.camera_files import speed_json
from proxnav.geometry.perturbation import difference
from proxnav.pose.solve.estimate import estimate_pose
from proxnav.storage.files import json_bytes
from proxnav.targets.loading import load_target

CAMERA = Camera(1024, 1024, 1407.0, 1407.0, 512.0, 512.0)
SIGMAS = (EXACT, CalibrationSigma(0.001, 0.5), CalibrationSigma(0.003, 2.0), CalibrationSigma(0.01, 5.0))
RANGES_M = (10.0, 20.0, 50.0, 100.0)
NOISE_PX = 1.5


def sight(range_m: float, camera: Camera, points_m: np.ndarray, rng: np.random.Generator) -> tuple[Pose, np.ndarray]:
    """(true pose in any attitude, noisy pixels as the erring camera sees them, NaN outside the picture)."""
    q = quaternion.normalize(rng.normal(size=4))
    T = Pose("cam", "target", q, np.array([*(0.05 * range_m * rng.normal(size=2)), range_m]))
    pixels = camera.erring(rng.normal(size=3)).project(T @ points_m)
    pixels = pixels + NOISE_PX * rng.normal(size=pixels.shape)
    return T, np.where(camera.contains(pixels)[:, None], pixels, np.nan)


def nees(T_true: Pose, T: Pose, covariance: np.ndarray) -> float:
    """Squared error in units of the claimed covariance."""
    e = difference(T, T_true)
    return float(e @ np.linalg.solve(covariance, e))


def by_python(sights: list[tuple[Pose, np.ndarray]], camera: Camera, points_m: np.ndarray) -> list[float]:
    """NEES of `estimate_pose`."""
    covariances = np.tile(NOISE_PX**2 * np.eye(2), (len(points_m), 1, 1))
    found = [(T, estimate_pose(points_m, pixels, camera, covariances)) for T, pixels in sights]
    return [nees(T, r.T_cam_target, r.covariance) for T, r in found if r.T_cam_target is not None]  # pyright: ignore


def by_command(sights: list[tuple[Pose, np.ndarray]], camera: Camera) -> list[float]:
    """NEES of `proxnav solve`, from files."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "camera.json").write_bytes(json_bytes(speed_json(camera)))
        entries = [_entry(i, pixels) for i, (_, pixels) in enumerate(sights)]
        (folder / "keypoints.json").write_bytes(json_bytes(entries))
        argv = ["solve", str(folder / "keypoints.json"), "--camera", str(folder / "camera.json")]
        if proxnav([*argv, "--target", "space-rider", "--out", str(folder / "poses.json")]) != 0:
            raise SystemExit("proxnav solve failed")
        found = read_poses(folder / "poses.json")
    pairs = [(T, found[f"{i:06d}.png"]) for i, (T, _) in enumerate(sights)]
    return [nees(T, r.T_cam_target, r.covariance) for T, r in pairs if r.T_cam_target is not None]  # pyright: ignore


def _entry(i: int, pixels: np.ndarray) -> dict[str, object]:
    seen = np.isfinite(pixels[:, :1])
    keypoints = np.concatenate([np.where(seen, pixels, 0.0), seen.astype(float)], axis=1)
    covariances = np.tile(NOISE_PX**2 * np.eye(2), (len(pixels), 1, 1))
    return {
        "file_name": f"{i:06d}.png",
        "keypoints": keypoints.ravel().tolist(),
        "covariances_px2": covariances.tolist(),
    }


def main() -> None:
    """Prints one line per declared error and range."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=400)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path)
    asked = parser.parse_args()
    points, rows = load_target("space-rider").keypoints_m, []
    for sigma in SIGMAS:
        for range_m in RANGES_M:
            rng = np.random.default_rng([asked.seed, int(range_m)])
            erring = replace(CAMERA, calibration_sigma=sigma)
            sights = [sight(range_m, erring, points, rng) for _ in range(asked.frames)]
            told, command = by_python(sights, erring, points), by_command(sights, erring)
            silent = by_python(sights, replace(CAMERA, calibration_sigma=EXACT), points)
            rows.append(
                {"focal": sigma.focal, "principal_px": sigma.principal_px, "range_m": range_m, "frames": asked.frames,
                 "poses": len(told), "nees": float(np.mean(told)), "nees_by_solve": float(np.mean(command)),
                 "poses_undeclared": len(silent), "nees_undeclared": float(np.mean(silent))}
            )  # fmt: skip
            print(json.dumps(rows[-1]), flush=True)
    if asked.json:
        asked.json.write_bytes(json_bytes(rows, indent=1))


if __name__ == "__main__":
    main()
