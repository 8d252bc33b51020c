"""Every numbered example runs as it stands, small, and gives what its first lines promise."""

import importlib.util
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"

pytestmark = pytest.mark.slow


def _main(number: int) -> Callable[..., Any]:
    (path,) = EXAMPLES.glob(f"{number:02d}_*.py")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.main


def test_examples_are_numbered_without_gaps_and_stay_short() -> None:
    paths = sorted(EXAMPLES.glob("*.py"))
    assert [path.name[:3] for path in paths] == [f"{k:02d}_" for k in range(1, 10)]
    assert all(len(path.read_text(encoding="utf-8").splitlines()) < 60 for path in paths)


def test_01_finds_the_pose_in_spite_of_lost_and_wrong_keypoints() -> None:
    result = _main(1)()
    assert result.status == "ok"
    assert not result.inliers[[0, 1]].any()
    np.testing.assert_allclose(result.T_cam_target.t_m, [1.0, -0.5, 40.0], atol=0.5)  # m


def test_02_draws_the_flight(tmp_path: Path) -> None:
    assert _main(2)(tmp_path, orbits=1.0).stat().st_size > 10_000


def test_03_makes_a_target_of_a_mesh_in_millimetres(tmp_path: Path) -> None:
    target = _main(3)(tmp_path, size=128)
    np.testing.assert_allclose(np.ptp(target.vertices_m, axis=0), [0.3, 1.6, 0.28], atol=1e-6)  # m
    assert len(target.keypoint_names) == 24
    assert (tmp_path / "03_target.png").is_file()


def test_04_renders_light_depth_and_parts(tmp_path: Path) -> None:
    frame = _main(4)(tmp_path, size=128)
    assert frame.mask.sum() > 100
    assert frame.radiance[frame.mask].max() > 1.0  # W/(m^2 sr)
    assert (tmp_path / "04_render_raycast.png").is_file()


def test_05_reads_more_counts_from_longer_exposures(tmp_path: Path) -> None:
    images = _main(5)(tmp_path, size=128)
    assert len(images) == 9
    for row in (0, 3, 6):
        means = [image.astype(float).mean() for image in images[row : row + 3]]
        assert means == sorted(means)


def test_06_writes_a_data_set_that_reads_back(tmp_path: Path) -> None:
    dataset = _main(6)(tmp_path, frames=2, size=128)
    assert len(dataset) == 2
    assert dataset.image(0).shape == (128, 128)
    assert (tmp_path / "06_dataset.png").is_file()


def test_07_scores_estimates_against_the_truth(tmp_path: Path) -> None:
    assert 0.0 < _main(7)(tmp_path, frames=20) < 0.05
    assert (tmp_path / "07_evaluate.png").is_file()


def test_08_keeps_the_position_within_a_metre(tmp_path: Path) -> None:
    assert np.linalg.norm(_main(8)(tmp_path, seconds=40.0)) < 1.0  # m, at 100 m
    assert (tmp_path / "08_navigation" / "solution.csv").is_file()


def test_09_flies_on_images_alone_to_where_its_path_leads() -> None:
    pytest.importorskip("Basilisk", reason="Basilisk is not installed: pip install bsk")
    assert _main(9)(seconds=100.0) == pytest.approx(24.0, abs=0.5)  # m
