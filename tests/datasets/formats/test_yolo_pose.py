"""YOLO-pose by its published description, and by the loader that trains on it where that is installed."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from proxnav.datasets.formats import Labels, ReadOptions, WriteOptions, read_labels, write_labels
from proxnav.errors import InputError

WHOLE = WriteOptions(validation_share=0.0)


def rows(out: Path, part: str = "train") -> dict[str, np.ndarray]:
    """The numbers of each label file, by the stem of its image."""
    return {p.stem: np.array(p.read_text().split(), dtype=float) for p in sorted((out / "labels" / part).glob("*.txt"))}


def test_lines_are_class_box_and_keypoints_in_parts_of_the_image(labels: Labels, tmp_path: Path) -> None:
    out = write_labels(labels, tmp_path / "out", "yolo-pose", WHOLE)
    content = yaml.safe_load((out / "data.yaml").read_text())
    assert content["kpt_shape"] == [8, 3]
    assert content["names"] == {0: "boxcraft"}
    assert (content["train"], content["val"]) == ("images/train", "images/train")
    assert "flip_idx" not in content  # a mirrored craft is no view of it
    for record in labels.records:
        row = rows(out)[Path(record.filename).stem]
        assert record.box_xyxy is not None
        assert record.keypoints_px is not None
        x0, y0, x1, y1 = record.box_xyxy
        expected = [0.0, (x0 + x1) / 128.0, (y0 + y1) / 96.0, (x1 - x0) / 64.0, (y1 - y0) / 48.0]
        np.testing.assert_allclose(row[:5], expected, atol=1e-9)
        points = row[5:].reshape(8, 3)
        np.testing.assert_array_equal(points[:, 2], record.visibility)
        seen = points[:, 2] > 0
        np.testing.assert_allclose(points[seen, :2] * [64, 48], record.keypoints_px[seen], atol=1e-7)
        assert (points[~seen] == 0.0).all()


def test_a_keypoint_outside_the_image_leaves_the_image_in_the_set(labels: Labels, tmp_path: Path) -> None:
    """Loaders refuse numbers outside 0 to 1 and drop the whole image; such a point is written 0 0 0."""
    first = labels.records[0]
    assert first.keypoints_px is not None
    far = first.keypoints_px.copy()
    far[0], far[1] = (-300.0, 20.0), (20.0, 900.0)
    moved = replace(labels, records=(replace(first, keypoints_px=far, visibility=None),))
    (row,) = rows(write_labels(moved, tmp_path / "out", "yolo-pose", WHOLE)).values()
    assert row.min() >= 0.0
    assert row[1:].reshape(-1)[:4].max() <= 1.0
    np.testing.assert_array_equal(row[5:].reshape(8, 3)[:2], np.zeros((2, 3)))


def test_poses_points_and_camera_lie_beside_it_and_come_back(labels: Labels, tmp_path: Path) -> None:
    back = read_labels(write_labels(labels, tmp_path / "out", "yolo-pose"))
    assert back.camera == labels.camera
    assert (back.keypoint_names, back.target_name) == (labels.keypoint_names, "boxcraft")
    np.testing.assert_allclose(back.keypoints_m, labels.keypoints_m, atol=1e-12)
    assert {record.split for record in back.records} == {"train", "validation"}
    originals = {record.filename: record for record in labels.records}
    for record in back.records:
        original = originals[record.filename]
        np.testing.assert_allclose(record.T_cam_target.matrix(), original.T_cam_target.matrix(), atol=1e-9)
        np.testing.assert_allclose(record.box_xyxy, original.box_xyxy, atol=1e-7)
        seen = original.visibility > 0
        np.testing.assert_allclose(record.keypoints_px[seen], original.keypoints_px[seen], atol=1e-6)


def foreign(folder: Path, line: str, **content: object) -> Path:
    """A set of somebody else, whose image is not there."""
    (folder / "labels" / "train").mkdir(parents=True)
    (folder / "labels" / "train" / "a.txt").write_text(line)
    stated = {"path": "../datasets/craft", "train": "images/train", "val": "images/train", "names": ["craft"]}
    (folder / "data.yaml").write_text(yaml.safe_dump(stated | {"kpt_shape": [2, 3]} | content))
    return folder


def test_a_set_of_somebody_else_is_read(labels: Labels, tmp_path: Path) -> None:
    folder = foreign(tmp_path / "in", "0 0.5 0.5 0.25 0.5 0.5 0.25 2 0 0 0\n")
    (record,) = read_labels(folder, options=ReadOptions(camera=labels.camera)).records
    assert (record.filename, record.split, record.T_cam_target) == ("a.png", "train", None)
    np.testing.assert_allclose(record.box_xyxy, [24.0, 12.0, 40.0, 36.0])
    np.testing.assert_allclose(record.keypoints_px, [[32.0, 12.0], [np.nan, np.nan]])
    two = foreign(tmp_path / "two", "0 0.5 0.5 0.25 0.5 0.5 0.25 0 0\n", kpt_shape=[2, 2])
    (record,) = read_labels(two / "data.yaml", options=ReadOptions(camera=labels.camera)).records
    np.testing.assert_array_equal(record.visibility, [2, 0])


@pytest.mark.parametrize(
    ("line", "content", "found"),
    [
        ("0 0.5 0.5 0.25 0.5\n", {}, "expected 11 numbers"),
        ("0 0.5 0.5 0.25 0.5 32 12 2 0 0 0\n", {}, "look like pixels"),
        ("0 0.5 0.5 0.2 0.5 0.5 0.2 7 0 0 0\n", {}, "flag is 0, 1 or 2"),
        ("0 .5 .5 .2 .5 .5 .2 2 0 0 0\n1 .5 .5 .2 .5 .5 .2 2 0 0 0\n", {}, "2 objects of class 0, 1"),
        ("0 0.5 x 0.25 0.5 32 12 2 0 0 0\n", {}, "expected a number, found 'x'"),
        ("", {"kpt_shape": 17}, "not a YOLO-pose set"),
        ("", {"train": "../../elsewhere"}, "leads out of"),
        ("", {"train": "images/none"}, "no folder or list of images"),
    ],
)
def test_a_malformed_set_is_one_sentence(
    line: str, content: dict[str, object], found: str, labels: Labels, tmp_path: Path
) -> None:
    folder = foreign(tmp_path / "in", line, **content)
    with pytest.raises(InputError, match=found) as error:
        read_labels(folder, options=ReadOptions(camera=labels.camera))
    assert "\n" not in str(error.value)


def test_boxes_without_keypoints_are_no_pose_set(tmp_path: Path) -> None:
    (tmp_path / "data.yaml").write_text("train: images/train\nnames: [craft]\n")
    with pytest.raises(InputError, match="no kpt_shape"):
        read_labels(tmp_path / "data.yaml")


@pytest.mark.filterwarnings("ignore")
def test_the_loader_that_trains_takes_every_image(labels: Labels, tmp_path: Path) -> None:
    """`ultralytics` (AGPL, not a dependency): no image is dropped, and its labels are ours."""
    pytest.importorskip("ultralytics", reason="ultralytics is not installed")
    from ultralytics.data.utils import check_det_dataset, verify_image_label

    out = write_labels(labels, tmp_path / "out", "yolo-pose")
    data = check_det_dataset(str(out / "data.yaml"), autodownload=False)
    count = 0
    for image in sorted((out / "images").rglob("*.png")):
        label = str(image).replace("/images/", "/labels/").replace(".png", ".txt")
        found = verify_image_label((str(image), label, "", True, len(data["names"]), *data["kpt_shape"], False))
        _, box, shape, _, keypoints, missing, _, empty, corrupt, message = found
        assert (missing, empty, corrupt, message, shape) == (0, 0, 0, "", (48, 64))
        record = next(r for r in labels.records if r.filename == image.name)
        seen = record.visibility > 0
        np.testing.assert_allclose(keypoints[0, seen, :2] * [64, 48], record.keypoints_px[seen], atol=1e-4)
        np.testing.assert_array_equal(keypoints[0, :, 2], record.visibility)
        assert box.shape == (1, 5)
        count += 1
    assert count == len(labels)
    assert len(json.loads((out / "poses.json").read_text())) == count
