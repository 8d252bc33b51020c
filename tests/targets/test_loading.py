"""Targets from files: scale, axes, materials, exact round trips, and files that lie."""

from pathlib import Path

import pytest

from proxnav.errors import InputError
from proxnav.targets.cad.from_mesh import from_mesh
from proxnav.targets.loading import load_target
from proxnav.targets.space_rider import space_rider
from proxnav.targets.target_files import save_target


def test_same_file_gives_the_same_object_until_it_changes(tmp_path: Path):
    save_target(space_rider(), tmp_path)
    first = load_target(str(tmp_path))
    assert load_target(str(tmp_path)) is first
    assert load_target("space-rider") is load_target("space-rider")


def test_unknown_names_are_refused(glb: Path):
    with pytest.raises(InputError, match="space-rider"):
        load_target("space-ridder")
    with pytest.raises(InputError, match="body, mast"):
        from_mesh(glb, without=["door"])
    with pytest.raises(InputError, match="not both"):
        from_mesh(glb, unit_m=1.0, length_m=2.0)
