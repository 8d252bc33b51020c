"""Keypoint files of other detectors."""

import json
from pathlib import Path

import numpy as np

from proxnav.pose.solve.keypoint_files import read_keypoints


def write(folder: Path, content: object) -> Path:
    (folder / "k.json").write_text(json.dumps(content))
    return folder / "k.json"


def test_numbers_names_and_shift(tmp_path: Path) -> None:
    path = write(tmp_path, [{"image_id": 12, "keypoints": [1.0, 2.0, 0.5, 3.0, 4.0, None]}])
    (record,) = read_keypoints(path, "centre")
    assert record.filename == "12"
    np.testing.assert_array_equal(record.pixels, [[1.5, 2.5], [3.5, 4.5]])
    np.testing.assert_array_equal(record.scores, [0.5, 0.0])
    assert record.covariances_px2 is None


def test_covariances_come_nested_or_flat(tmp_path: Path) -> None:
    nested = [[[1.0, 0.2], [0.2, 2.0]], [[3.0, 0.0], [0.0, 4.0]]]
    for values in (nested, np.ravel(nested).tolist()):
        entry = {"file_name": "a.png", "keypoints": [1, 2, 1, 3, 4, 1], "covariances_px2": values}
        (record,) = read_keypoints(write(tmp_path, [entry]))
        np.testing.assert_array_equal(record.covariances_px2, nested)
