"""SPEED+ as it is distributed: what is found, and how it is scored."""

import json
from pathlib import Path

import numpy as np
import pytest

from proxnav.benchmarks.speedplus import light_of, score_row, table
from proxnav.benchmarks.speedplus_folders import find_domains
from proxnav.datasets.formats.speed_poses import PoseRecord, write_poses
from proxnav.errors import InputError
from proxnav.evaluation.pairing import pair
from proxnav.geometry import Pose
from proxnav.images.codecs import encode_png


def pose(turn_deg: float, z_m: float = 6.0) -> Pose:
    half = np.radians(turn_deg) / 2.0
    return Pose.from_wxyz("cam", "target", [np.cos(half), 0.0, np.sin(half), 0.0], [0.0, 0.0, z_m])


def domain(folder: Path, names: list[str], labels: str = "test.json", lost: int = 0) -> Path:
    """A folder with black images and their labels, the last `lost` without an image."""
    (folder / "images").mkdir(parents=True)
    for name in names[: len(names) - lost]:
        (folder / "images" / name).write_bytes(encode_png(np.zeros((8, 8), np.uint8)))
    write_poses(folder / labels, [PoseRecord(name, pose(0.0), "truth") for name in names])
    return folder


def test_domains_are_found_as_distributed_and_as_single_folders(tmp_path: Path) -> None:
    domain(tmp_path / "speedplus" / "lightbox", ["a.png", "b.png"])
    domain(tmp_path / "speedplus" / "synthetic", ["a.png"], "validation.json")
    (tmp_path / "speedplus" / "camera.json").write_text("{}")
    assert [d.name for d in find_domains(tmp_path / "speedplus")] == ["lightbox", "synthetic"]
    assert [d.name for d in find_domains(tmp_path / "speedplus" / "lightbox")] == ["lightbox"]


def test_labels_without_an_image_are_counted_and_a_limit_takes_images_from_first_to_last(tmp_path: Path) -> None:
    folder = domain(tmp_path / "sunlamp", [f"{k}.png" for k in range(6)], lost=1)
    (found,) = find_domains(folder, limit=3)
    assert (found.missing, [path.name for path in found.images]) == (1, ["0.png", "2.png", "4.png"])


@pytest.mark.parametrize(("lost", "match"), [(2, "none of its 2 images"), (0, "no folder in it has labels")])
def test_a_folder_without_labels_or_images_is_refused(tmp_path: Path, lost: int, match: str) -> None:
    root = domain(tmp_path / "lightbox", ["a.png", "b.png"], lost=lost) if lost else tmp_path
    with pytest.raises(InputError, match=match):
        find_domains(root)


def test_scores_by_hand() -> None:
    truth = {name: PoseRecord(name, pose(0.0), "truth") for name in "abc"}
    sure = np.eye(6) * 1e-6
    found = {
        "a": PoseRecord("a", pose(0.1), covariance=sure),
        "b": PoseRecord("b", pose(20.0, 6.3), covariance=sure),
        "c": PoseRecord("c", None, "no_target"),
    }
    row = score_row(pair(found, truth))
    assert (row["frames"], row["poses"], row["hazardous"], row["gross_and_sure"]) == (3, 2, 1, 1)
    assert row["below_10_deg"] == pytest.approx(1 / 3)  # a refusal is no pose below 10 deg
    assert row["mean_e_r_deg"] == pytest.approx(10.05)
    assert row["scores"]["e_tn + e_r [rad]"] == pytest.approx((np.radians(20.1) + 0.05) / 2)
    assert row["scores"]["SPEC2021 dead zone (0.169 deg, 2.173 mm/m)"] == pytest.approx((np.radians(20.0) + 0.05) / 2)
    text = table({"domains": {"lightbox": {"rows": {"all": row}, "images_without_a_file": 0}}})
    assert "2/3" in text
    assert "SPNv2" in text
    assert json.loads(json.dumps(row)) == row


def test_light_is_told_from_the_picture() -> None:
    grey = np.full((100, 100), 100, np.uint8)
    assert [light_of(grey), light_of(grey // 2)] == ["even light", "dark"]
    grey[:11] = 255
    assert light_of(grey) == "saturated"
