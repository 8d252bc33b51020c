"""A target on disk."""

import json
from pathlib import Path

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.targets.cad.from_mesh import from_mesh
from proxnav.targets.loading import load_target
from proxnav.targets.space_rider import space_rider
from proxnav.targets.target import Target
from proxnav.targets.target_files import save_target


def test_saving_and_loading_gives_back_every_number(tmp_path: Path, glb: Path):
    for target in (space_rider(), from_mesh(glb, unit_m=1.0)):
        save_target(target, tmp_path / target.name)
        assert same(target, load_target(str(tmp_path / target.name)))
        assert same(target, load_target(str(tmp_path / target.name / "target.json")))


def test_target_json_that_lies_is_refused(tmp_path: Path):
    path = save_target(space_rider(), tmp_path)
    good = json.loads(path.read_text())
    for change, says in (
        ({"version": 9}, "version 1"),
        ({"mesh": "../secret.npz"}, "mesh.npz"),
        ({"parts": good["parts"][:3]}, "face_part"),
        ({"keypoints_m": [[0, 0]]}, "malformed|shape"),
        ({"subsets": {"six": [99]}}, "subsets"),
        ({"parts": [p | {"kind": "velvet"} for p in good["parts"]]}, "velvet"),
    ):
        path.write_text(json.dumps(good | change))
        with pytest.raises(InputError, match=says):
            load_target(str(path))
    path.write_text(json.dumps(good))
    (tmp_path / "mesh.npz").write_bytes(b"PK nothing")
    with pytest.raises(InputError, match="not a readable mesh"):
        load_target(str(path.parent))


def same(a: Target, b: Target) -> bool:
    arrays = ("vertices_m", "faces", "face_part", "corner_normals", "corner_uv_m", "keypoints_m")
    values = ("name", "part_names", "materials", "keypoint_names", "licence", "source")
    exact = all(np.array_equal(getattr(a, k), getattr(b, k)) for k in arrays)
    return exact and all(getattr(a, k) == getattr(b, k) for k in values) and dict(a.subsets) == dict(b.subsets)
