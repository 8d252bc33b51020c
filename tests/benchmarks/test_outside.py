"""Flights by Basilisk: the same gravity as ours, and a filter that stays honest where craft are not simple."""

from dataclasses import replace

import numpy as np
import pytest

from navigation.flights import CAMERA
from proxnav.benchmarks.monte_carlo import Case
from proxnav.benchmarks.outside import ROWS
from proxnav.benchmarks.outside_flight import OutsideFlight, OutsideJob, fly_case, outside_truth
from proxnav.flight.orbit_forces import ForceConfig, fly
from proxnav.geometry import quaternion

pytest.importorskip("Basilisk", reason="Basilisk is not installed: pip install bsk")


def test_basilisk_and_our_own_forces_move_two_craft_alike() -> None:
    truth, _ = outside_truth(OutsideFlight(air=0.0), 200.0, np.random.default_rng(0))
    start = np.concatenate(
        [truth.r_eci_target_m[0], truth.v_eci_target_mps[0], truth.r_eci_chaser_m[0], truth.v_eci_chaser_mps[0]]
    )
    ours = fly(start, truth.t, ForceConfig(density_kg_m3=0.0))
    np.testing.assert_allclose(truth.r_eci_target_m, ours[:, :3], atol=1e-3)  # m
    relative = truth.r_eci_chaser_m - truth.r_eci_target_m
    np.testing.assert_allclose(relative, ours[:, 6:9] - ours[:, :3], atol=1e-6)  # m


def test_arms_lead_from_the_centres_of_mass_to_camera_and_origin() -> None:
    flight = OutsideFlight(tumble_deg_s=1.0, target_centre_m=(0.5, 0.0, 0.1), chaser_centre_cam_m=(0.0, -0.4, 0.0))
    truth, centres = outside_truth(flight, 60.0, np.random.default_rng(1))
    back = quaternion.rotate(quaternion.conjugate(truth.q_eci_target), centres.r_eci_target_m - truth.r_eci_target_m)
    np.testing.assert_allclose(back, np.tile(flight.target_centre_m, (len(truth.t), 1)), atol=1e-6)
    moved = np.gradient(truth.r_eci_target_m, truth.t, axis=0)[1:-1]
    np.testing.assert_allclose(moved, truth.v_eci_target_mps[1:-1], atol=5e-3)  # m/s: central differences at 8 km/s


@pytest.mark.parametrize("name", ["origin 0.54 m off, tumbling", "white pose errors"])
def test_the_filter_stays_honest_where_craft_differ_from_what_it_is_told(name: str) -> None:
    flight, config = ROWS[name]
    job = OutsideJob(replace(flight, gnss="none"), "space-rider", CAMERA, config, seconds=240.0)
    found = [fly_case(Case(name, seed), job) for seed in range(3)]
    assert [run.starts for run in found] == [1, 1, 1]
    assert 5.0 < np.mean([run.nees for run in found]) < 24.0  # 12 on average; three flights say little more
    assert np.mean([np.abs(run.errors) <= 3.0 * run.sigmas for run in found]) > 0.97
