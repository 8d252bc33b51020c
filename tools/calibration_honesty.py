"""Measures whether covariances stay honest when the camera's intrinsics err by what is declared of them.

Keypoints of Space Rider with Gaussian noise are seen by a camera that errs by draws of `calibration_sigma`; the pose is
solved with the nominal camera. Honest covariances give a mean NEES of 6 for the 6 errors of a pose. Flights of four
minutes 30 m away, without GNSS, do the same for the filter, whose solution has 12 errors.

    python tools/calibration_honesty.py --frames 400 --flights 12
"""

import argparse
import json
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal

import numpy as np

from proxnav.cli.main import main as proxnav
from proxnav.datasets.formats.speed_poses import read_poses
from proxnav.evaluation.navigation_errors import nav_errors
from proxnav.flight.simulate import SensingConfig, SimulationConfig, simulate
from proxnav.flight.truth import TruthConfig
from proxnav.flight.truth_files import true_states
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.geometry.calibration import EXACT, CalibrationSigma
from proxnav.geometry.camera_files import speed_json
from proxnav.geometry.perturbation import difference
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import setup_of
from proxnav.navigation.navigator import run_filter
from proxnav.pose.solve.estimate import estimate_pose
from proxnav.storage.files import json_bytes
from proxnav.targets.loading import load_target
from proxnav.trajectories import HoldConfig, hold

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


def flight_nees(seed: int, coupling: Literal["loose", "tight"], assumed: Camera, seen_by: Camera) -> float:
    """Mean NEES of the second half of a flight whose records come from `seen_by`, filtered with another camera."""
    rng, target = np.random.default_rng(seed), load_target("space-rider")
    sensing = SimulationConfig(TruthConfig(step_s=0.5), SensingConfig(gnss="none"))
    truth, records = simulate(hold(HoldConfig(duration_s=240.0, step_s=10.0)), target, seen_by, sensing, rng)
    config, sigma = NavigationConfig(coupling=coupling), seen_by.calibration_sigma
    t = np.arange(truth.t[0] + 120.0, truth.t[-1], 20.0)
    states, _, _ = run_filter(records, setup_of(records, target.keypoints_m, assumed, config, sigma), t)
    return float(np.nanmean(nav_errors(states, true_states(truth).at(t)).nees))


def flight_rows(flights: int) -> list[dict[str, object]]:
    """NEES of the filter, told of the camera's errors and not."""
    sigma, rows = SIGMAS[-1], []
    unsure = replace(CAMERA, calibration_sigma=sigma)
    for coupling in ("loose", "tight"):
        told, silent = (
            float(np.mean([flight_nees(seed, coupling, assumed, unsure) for seed in range(flights)]))
            for assumed in (unsure, CAMERA)
        )
        rows.append(
            {"focal": sigma.focal, "principal_px": sigma.principal_px, "coupling": coupling, "flights": flights,
             "nees_of_12": told, "nees_undeclared": silent}
        )  # fmt: skip
        print(json.dumps(rows[-1]), flush=True)
    return rows


def pose_rows(frames: int, seed: int) -> list[dict[str, object]]:
    """NEES of single poses by declared error and range; prints them as they come."""
    points, rows = load_target("space-rider").keypoints_m, []
    for sigma in SIGMAS:
        for range_m in RANGES_M:
            rng = np.random.default_rng([seed, int(range_m)])
            erring = replace(CAMERA, calibration_sigma=sigma)
            sights = [sight(range_m, erring, points, rng) for _ in range(frames)]
            told, command = by_python(sights, erring, points), by_command(sights, erring)
            silent = by_python(sights, replace(CAMERA, calibration_sigma=EXACT), points)
            rows.append(
                {"focal": sigma.focal, "principal_px": sigma.principal_px, "range_m": range_m, "frames": frames,
                 "poses": len(told), "nees": float(np.mean(told)), "nees_by_solve": float(np.mean(command)),
                 "poses_undeclared": len(silent), "nees_undeclared": float(np.mean(silent))}
            )  # fmt: skip
            print(json.dumps(rows[-1]), flush=True)
    return rows


def main() -> None:
    """Prints one line per declared error and range."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=400)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--flights", type=int, default=12)
    asked = parser.parse_args()
    rows = pose_rows(asked.frames, asked.seed) + flight_rows(asked.flights)
    if asked.json:
        asked.json.write_bytes(json_bytes(rows, indent=1))


if __name__ == "__main__":
    main()
