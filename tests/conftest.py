"""Fixtures shared by all rooms."""

from pathlib import Path

import numpy as np
import pytest

from proxnav.datasets.set.dataset import Dataset

SHARED_DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
RAY = {"test_ray.py", "test_on_ray.py", "test_flights.py"}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """For `-n 2 --dist loadgroup`: a file's tests share a process, all of Ray's one; files that take long start."""
    long = {item.path for item in items for mark in ("slow", "blender") if item.get_closest_marker(mark)}
    for item in items:
        item.add_marker(pytest.mark.xdist_group("ray" if item.path.name in RAY else str(item.path)))
    items.sort(key=lambda item: item.path not in long)


@pytest.fixture
def rng() -> np.random.Generator:
    """A generator with a fixed seed."""
    return np.random.default_rng(20241101)


@pytest.fixture
def shared_data() -> Path:
    """Folder with real files from the field; tests that need it skip where it is absent."""
    if not SHARED_DATA.is_dir():
        pytest.skip("the sample files of ../shared/data are not beside this clone")
    return SHARED_DATA


@pytest.fixture(scope="session")
def six(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Six ray-cast frames of 96 px, drawn without interruption by one process."""
    from proxnav.frames import FrameConfig
    from proxnav.missions import load_mission
    from proxnav.missions.scenes import draw_scenes
    from proxnav.rendered_set import render

    scenes = draw_scenes(load_mission("observation-10-100m"), 6, 3, 96)
    return render(scenes, FrameConfig("raycast"), tmp_path_factory.mktemp("sets") / "six", 1)
