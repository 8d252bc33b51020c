"""How fast a flight teaches the filter the geometry of both craft and the camera's clock: one figure, and a table.

python tools/observability.py docs/gallery/observability.png
"""

import json
import sys
from dataclasses import replace
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from proxnav.flight.sensors.star_tracker import StarTrackerConfig
from proxnav.flight.simulate import SensingConfig, SimulationConfig, simulate
from proxnav.flight.truth import TruthConfig, TumbleConfig
from proxnav.missions import fly, load_mission
from proxnav.navigation.belief import Tracking
from proxnav.navigation.config import CraftGeometry, NavigationConfig
from proxnav.navigation.filter_setup import setup_of
from proxnav.navigation.layout import E
from proxnav.navigation.navigator import Navigator
from proxnav.navigation.stream import readings
from proxnav.records import Trajectory
from proxnav.targets.loading import load_target

SECONDS = 1500.0
STATES = {"target's centre of mass": E.target_centre, "chaser's centre of mass": E.chaser_centre,
          "misalignment": E.misalignment, "clock": E.clock}  # fmt: skip
FLIGHTS = {
    "spiral": ("spiral-10-100m", TruthConfig(step_s=1.0), NavigationConfig()),
    "tumble at 1 deg/s": (
        "spiral-10-100m", TruthConfig(step_s=1.0, tumble=TumbleConfig((0.43, 0.86, 0.26))),
        NavigationConfig(target="free"),
    ),
    "approach": ("approach-100-10m", TruthConfig(step_s=1.0, burn_interval_s=30.0), NavigationConfig()),
}  # fmt: skip


def piece(reference: Trajectory) -> Trajectory:
    """The first `SECONDS` of a trajectory."""
    k = np.flatnonzero(reference.t <= reference.t[0] + SECONDS)
    names = [name for name in reference.__dataclass_fields__ if name not in ("epoch_utc", "source")]
    return replace(reference, **{name: getattr(reference, name)[k] for name in names})


def learnt(name: str) -> tuple[np.ndarray, np.ndarray]:
    """(seconds, standard deviation of each error of the geometry as a share of the first) along a flight."""
    mission_name, truth_config, config = FLIGHTS[name]
    mission = load_mission(mission_name)
    target, sensing = load_target(mission.target), SensingConfig(star_tracker=StarTrackerConfig(rate_hz=1.0))
    truth, records = simulate(
        piece(fly(mission.flight.trajectory)), target, mission.camera, SimulationConfig(truth_config, sensing),
        np.random.default_rng(1),
    )  # fmt: skip
    setup = setup_of(records, target.keypoints_m, mission.camera, config)
    navigator, stream, k, rows = Navigator(setup, float(truth.t[0])), readings(records, setup), 0, []
    for t in np.arange(truth.t[0] + 5.0, truth.t[-1], 5.0):
        while k < len(stream) and stream[k].received <= t:
            navigator.put(stream[k])
            k += 1
        belief = navigator.belief
        if isinstance(belief, Tracking):
            rows.append((t - truth.t[0], np.sqrt(np.diagonal(belief.P)[E.geometry])))
    return np.array([t for t, _ in rows]), np.array([sigma for _, sigma in rows]) / CraftGeometry().sigmas


def main(path: Path) -> None:
    """Draws the figure and prints what is left of each first uncertainty after 1, 5 and 20 minutes."""
    figure, axes = plt.subplots(1, len(FLIGHTS), figsize=(12, 3.6), sharey=True)
    table = {}
    for axis, name in zip(axes, FLIGHTS, strict=True):
        t, shares = learnt(name)
        for label, block in STATES.items():
            own = shares[:, block.start - E.geometry.start : block.stop - E.geometry.start]
            (line,) = axis.semilogy(t / 60.0, own[:, 0], label=label)
            axis.semilogy(t / 60.0, own[:, 1:], color=line.get_color())
            at = np.minimum(np.searchsorted(t, [60.0, 300.0, 1200.0]), len(t) - 1)
            table[f"{name}, {label}"] = np.round(own[at], 3).T.tolist()
        axis.set(title=name, xlabel="time [min]", ylim=(1e-3, 1.3))
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("sigma / first sigma [-], each axis")
    axes[0].legend(fontsize=8, loc="lower left")
    figure.tight_layout()
    figure.savefig(path, dpi=80)
    print(json.dumps(table, indent=1))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
