"""A lit stretch of a mission's flight, flown under real forces: its frames as scenes, and what its sensors read."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from proxnav.closed_loop import LATENCY_S, flown
from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.datasets.sensor_records.record_files import write_records
from proxnav.flight.simulate import SensingConfig, sense
from proxnav.flight.truth import Truth, TruthConfig, simulate_truth
from proxnav.flight.truth_files import true_states, write_truth
from proxnav.geometry.camera_files import speed_json
from proxnav.missions import Mission, fly_mission
from proxnav.missions.daylight import in_light
from proxnav.missions.scenes import follow
from proxnav.records import PoseData, SceneSpec, Trajectory
from proxnav.storage.files import write_json
from proxnav.targets.loading import load_target
from proxnav.trajectories.selection import clip_time

LONGEST_S = 1500.0
"""A quarter of an orbit: filtered within seconds."""
_STEP_S = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class PhotographedFlight:
    """A flight and the frames that are taken on it."""

    mission: Mission
    truth: Truth
    scenes: list[SceneSpec]
    seed: int

    @staticmethod
    def of(mission: Mission, frames: int, seed: int) -> "PhotographedFlight":
        """The longest lit stretch of the mission's flight, `frames` scenes spread over it.

        InputError where the mission has no flight, or one that is dark.
        """
        reference = lit_stretch(fly_mission(mission), mission)
        # Shipped weights were trained with zenith up.
        truth = simulate_truth(reference, TruthConfig(_STEP_S, camera_up="zenith"), np.random.default_rng(seed))
        seen = follow(flown(truth, np.arange(len(truth))), mission, frames, seed)
        return PhotographedFlight(mission, truth, seen, seed)

    def write_records(self, folder: Path, poses: Sequence[PoseRecord]) -> int:
        """Sensor records with the poses of the frames, the truth and the camera, as `simulate` writes them.

        How many poses there are; nothing is written for none.
        """
        taken = zip(self.scenes, poses, strict=True)
        found = [(scene.t, T, one.covariance) for scene, one in taken if (T := one.T_cam_target) is not None]
        if not found:
            return 0
        target, camera = load_target(self.mission.target), self.mission.camera
        sensed = sense(self.truth, target, camera, SensingConfig(), np.random.default_rng(self.seed + 1))
        t = np.array([t for t, _, _ in found])
        data = PoseData(
            t, t + LATENCY_S, np.array([T.q_wxyz for _, T, _ in found]), np.array([T.t_m for _, T, _ in found]),
            np.array([covariance for _, _, covariance in found]),
        )  # fmt: skip
        write_records(folder, replace(sensed, keypoints=None, poses=data))
        write_truth(folder / "truth.csv", true_states(self.truth, round(1.0 / _STEP_S)))
        write_json(folder / "camera.json", speed_json(camera), indent=1)
        return len(found)


def lit_stretch(trajectory: Trajectory, mission: Mission) -> Trajectory:
    """The longest piece without a gap of what the mission wants lit, `LONGEST_S` of it at most."""
    lit = in_light(trajectory, mission)
    gaps = np.flatnonzero(np.diff(lit.t) > 1.5 * np.diff(trajectory.t).max())
    firsts, lasts = lit.t[np.r_[0, gaps + 1]], lit.t[np.r_[gaps, len(lit) - 1]]
    k = int(np.argmax(lasts - firsts))
    return clip_time(trajectory, float(firsts[k]), min(float(lasts[k] - firsts[k]), LONGEST_S))
