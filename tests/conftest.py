"""Fixtures shared by all rooms."""

from pathlib import Path

import numpy as np
import pytest

SHARED_DATA = Path(__file__).resolve().parents[2] / "shared" / "data"


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
