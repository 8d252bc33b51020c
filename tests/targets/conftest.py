"""A small craft as a mesh file."""

from pathlib import Path

import pytest
from tests.targets.mesh_files import craft


@pytest.fixture
def glb(tmp_path: Path) -> Path:
    path = tmp_path / "craft.glb"
    craft().export(path)
    return path
