"""The filter's tables: consistency, accuracy, faults and speed, on truth that the filter does not know."""

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Literal

from proxnav.benchmarks.campaign import Campaign
from proxnav.benchmarks.filter_speed import measure_speed
from proxnav.benchmarks.monitoring import monitoring
from proxnav.benchmarks.monte_carlo import RunJob, honesty, judge_fault, summarise
from proxnav.benchmarks.navigation_parts import Part
from proxnav.benchmarks.outside import ROWS
from proxnav.benchmarks.outside_flight import OutsideJob
from proxnav.flight.faults import Fault
from proxnav.flight.sensors.star_tracker import StarTrackerConfig
from proxnav.flight.simulate import Grade, SensingConfig, SimulationConfig
from proxnav.flight.truth import TruthConfig, TumbleConfig
from proxnav.missions import fly, load_mission
from proxnav.navigation.config import SURVEYED, FilterNoise, NavigationConfig
from proxnav.storage.files import write_json

FAULTS: dict[Fault, float] = {
    "wrong_frames": 900.0, "camera_lost": 1200.0, "gnss_lost": 900.0, "gyro_step": 900.0, "late_camera": 900.0,
    "disorder": 900.0, "half_orbit_dark": 2760.0,
}  # fmt: skip
"""Length of the runs with each fault [s]; where the camera is lost, five minutes are left after it."""


def measure_navigation(parts: Sequence[Part], campaign: Campaign) -> dict[str, Any]:
    """The tables that are asked for, each written as soon as it is there, with the time that it took."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")  # the workers' own: one core each
    measures: dict[Part, Callable[[Campaign], dict[str, Any]]] = {
        "consistency": consistency, "accuracy": accuracy, "faults": faults, "speed": speed,
        "outside": outside,
        "monitor": monitor,
    }  # fmt: skip
    found = {}
    for part in parts:
        started = time.monotonic()
        found[part] = measures[part](campaign) | {"wall_s": time.monotonic() - started}
        if campaign.out is not None:
            write_json(campaign.out / f"navigation_{part}.json", found[part], indent=1)
    return found


def consistency(campaign: Campaign) -> dict[str, Any]:
    """Loose and tight coupling, on the spiral and on the approach, with correlated camera errors."""
    jobs = {
        f"{flight}, {coupling}": _job(flight, 900.0, "code", coupling=coupling)
        for flight in ("spiral-10-100m", "approach-100-10m")
        for coupling in ("loose", "tight")
    }
    return campaign.table("consistency", jobs, lambda name, job: summarise(campaign.flown(name, job)))


def accuracy(campaign: Campaign) -> dict[str, Any]:
    """What each sensor adds; every line has the star tracker, without which nothing is known in orbit axes."""
    jobs = {
        "camera": _job("spiral-10-100m", 900.0, "none", gyro=False),
        "camera + gyro": _job("spiral-10-100m", 900.0, "none"),
        "camera + gyro + code GNSS": _job("spiral-10-100m", 900.0, "code"),
        "camera + gyro + carrier GNSS": _job("spiral-10-100m", 900.0, "carrier"),
    }
    return campaign.table("accuracy", jobs, lambda name, job: summarise(campaign.flown(name, job)))


def faults(campaign: Campaign) -> dict[str, Any]:
    """Each fault alone, loose coupling with gyro and code GNSS; wrong frames, which differ, with tight coupling too."""
    jobs: dict[str, RunJob] = {name: _job("spiral-10-100m", seconds, "code") for name, seconds in FAULTS.items()}
    jobs["wrong_frames, tight"] = _job("spiral-10-100m", FAULTS["wrong_frames"], "code", coupling="tight")
    kinds: dict[str, Fault] = {"wrong_frames, tight": "wrong_frames", **{name: name for name in FAULTS}}
    return campaign.table("faults", jobs, lambda name, job: judge_fault(campaign.flown(name, job, kinds[name])))


def outside(campaign: Campaign) -> dict[str, Any]:
    """Truth that Basilisk made, round craft that differ from what the filter is told."""
    mission = load_mission("spiral-10-100m")
    jobs = {name: OutsideJob(flight, mission.target, mission.camera, config) for name, (flight, config) in ROWS.items()}
    return campaign.table("outside", jobs, lambda name, job: honesty(campaign.flown(name, job)))


def speed(_: Campaign) -> dict[str, Any]:
    """Time of one prediction and one update with 24 keypoints on one core."""
    return measure_speed(load_mission("spiral-10-100m").camera, "space-rider")


def monitor(campaign: Campaign) -> dict[str, Any]:
    """What the monitor says of honest flights, of faults that the filter copes with, and of wrong records."""
    spiral, approach = _job("spiral-10-100m", 900.0, "code"), _job("approach-100-10m", 900.0, "carrier")
    tumbling = replace(spiral.simulation, truth=replace(spiral.simulation.truth, tumble=TumbleConfig()))
    free = replace(spiral.filter, target="free", inertia=TumbleConfig().inertia)
    return monitoring(
        {"spiral, code GNSS": spiral, "approach, carrier GNSS": approach,
         "spiral, tumbling": replace(spiral, simulation=tumbling, filter=free)}, campaign,
    )  # fmt: skip


def _job(
    flight: str, seconds: float, gnss: Grade, coupling: Literal["loose", "tight"] = "loose", gyro: bool = True
) -> RunJob:
    noise = replace(FilterNoise(), gnss_bias_m=0.03, gnss_tau_s=600.0) if gnss == "carrier" else FilterNoise()
    truth = TruthConfig(step_s=1.0, burn_interval_s=30.0 if flight.startswith("approach") else 600.0)
    sensing = SensingConfig(gnss=gnss, star_tracker=StarTrackerConfig(rate_hz=1.0))
    mission = load_mission(flight)
    return RunJob(
        fly(mission.flight.trajectory), seconds, mission.target, mission.camera,
        SimulationConfig(truth, sensing),
        NavigationConfig(coupling=coupling, gyro=gyro, noise=noise, geometry=SURVEYED),
    )  # fmt: skip
