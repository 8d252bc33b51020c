"""A small data set, on disk and read."""

from pathlib import Path

import pytest
from tests.datasets.formats.small_sets import make_dataset

from proxnav.datasets.formats import Labels, read_labels


@pytest.fixture
def dataset(tmp_path: Path) -> Path:
    """Six frames of the test box, 8 m to 100 m away, as a data set folder of ours."""
    return make_dataset(tmp_path / "set")


@pytest.fixture
def labels(dataset: Path) -> Labels:
    return read_labels(dataset)
