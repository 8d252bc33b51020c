"""A servicer closes the loop through our images, or through the truth in their place."""

from pathlib import Path

import numpy as np
import pytest

from proxnav.benchmarks.servicing_flight import ServicedTarget, ServicingPath
from proxnav.benchmarks.servicing_loop import LoopConfig, fly_loop

pytest.importorskip("Basilisk", reason="Basilisk is not installed: pip install bsk")

PATH = ServicingPath(far_m=30.0, near_m=24.0, hold_s=10.0, approach_s=60.0, round_s=4000.0)
TUMBLING = ServicedTarget(tumble_deg_s=(0.3, 0.4, 0.2))


def test_with_true_poses_the_servicer_stays_on_its_path_and_the_run_reads_back(tmp_path: Path) -> None:
    from proxnav.datasets.sensor_records.record_files import read_records
    from proxnav.evaluation.solution_files import read_solution
    from proxnav.flight.truth_files import read_truth
    from proxnav.geometry import Camera

    run = fly_loop(LoopConfig(poses="true", path=PATH, seconds=60.0, size_px=64), tmp_path)
    assert run.summary["end_off_path_m"] < 0.15  # m, half way through a move that the control does not foresee
    assert np.linalg.norm(run.errors.errors[-1, :3]) < 0.01  # m
    records, solution = read_records(tmp_path).records, read_solution(tmp_path)
    assert records.poses is not None
    assert solution is not None
    assert len(records.poses.t) == 31
    assert Camera.read(tmp_path / "camera.json").width == 64
    np.testing.assert_allclose(read_truth(tmp_path / "truth.csv").r_ric_m[-1], run.truth.relative[0][-1], atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("target", [ServicedTarget(), TUMBLING], ids=["held", "tumbling"])
def test_two_minutes_of_approach_seeing_only_images_end_near_the_path(target: ServicedTarget, tmp_path: Path) -> None:
    run = fly_loop(LoopConfig(path=PATH, serviced=target, seconds=120.0, size_px=512), tmp_path)
    assert run.summary["poses"] > 25  # of 61: a tumbling target turns its dark side to the camera
    assert run.summary["mean_end_off_path_m"] < 1.5  # m, at 24 m: poses of one view share an error of decimetres
    assert run.summary["nearest_surface_m"] > 15.0
