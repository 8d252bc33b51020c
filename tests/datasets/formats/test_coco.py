"""COCO as its own tools and the usual loaders read it."""

import contextlib
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pycocotools import mask as coco_mask
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

from proxnav.datasets.formats import Labels, ReadOptions, read_labels, write_labels
from proxnav.errors import InputError
from proxnav.images.codecs import encode_png

KEYPOINTS = [10.0, 12.0, 2, 30.0, 20.0, 1, 0.0, 0.0, 0]


def judged(truth: Path, kind: str) -> float:
    """COCO's average precision of predictions that repeat the truth."""
    content = json.loads(truth.read_text())
    with contextlib.redirect_stdout(io.StringIO()):
        coco = COCO(str(truth))
        found = [
            {"image_id": e["image_id"], "category_id": 1, "score": 0.9, "bbox": e["bbox"], "keypoints": e["keypoints"]}
            for e in content["annotations"]
        ]
        judge = COCOeval(coco, coco.loadRes(found), kind)
        judge.params.kpt_oks_sigmas = np.full(len(content["categories"][0]["keypoints"]), 0.05)
        judge.evaluate()
        judge.accumulate()
        judge.summarize()
    return float(judge.stats[0])


@pytest.mark.parametrize("kind", ["bbox", "keypoints"])
@pytest.mark.parametrize("format", ["rendered", "coco", "detectron2"])
def test_perfect_predictions_are_perfect_to_the_judge_of_coco(
    kind: str, format: str, dataset: Path, labels: Labels, tmp_path: Path
) -> None:
    """COCOeval takes annotation 0 for "unmatched": a set whose ids begin at 0 loses its first frame."""
    folder = dataset if format == "rendered" else write_labels(labels, tmp_path / "out", format)
    assert judged(folder / "annotations.json", kind) == pytest.approx(1.0)


@pytest.mark.filterwarnings("ignore:__array__:DeprecationWarning")  # of pycocotools itself
def test_masks_are_what_the_converter_of_detr_and_torchvision_takes(dataset: Path, labels: Labels) -> None:
    """`frPyObjects` of every segmentation, as both convert COCO, gives the mask back without loss."""
    content = json.loads((dataset / "annotations.json").read_text())
    for entry, record in zip(content["annotations"], labels.records, strict=True):
        assert record.mask is not None
        decoded = coco_mask.decode(coco_mask.frPyObjects(entry["segmentation"], 48, 64))
        expected = np.zeros((48, 64), dtype=np.uint8)
        expected[10:20, 20 : 31 + int(record.filename[3:-4])] = 1
        np.testing.assert_array_equal(decoded, expected)


def foreign(folder: Path, **changes: Any) -> Path:
    """A COCO keypoint file of somebody else: no poses, no camera, ids of its own, one image without the target."""
    annotation = {"id": 7, "image_id": 5, "category_id": 3, "bbox": [8.0, 10.0, 30.0, 20.0], "keypoints": KEYPOINTS}
    content = {
        "images": [
            {"id": 5, "file_name": "a.png", "width": 64, "height": 48},
            {"id": 9, "file_name": "b.png", "width": 64, "height": 48},
        ],
        "annotations": [annotation | changes],
        "categories": [{"id": 3, "name": "craft", "keypoints": ["p", "q", "r"]}],
    }
    folder.mkdir(exist_ok=True)
    (folder / "labels.json").write_text(json.dumps(content))
    for image in content["images"]:
        (folder / image["file_name"]).write_bytes(encode_png(np.zeros((48, 64), dtype=np.uint8)))
    return folder / "labels.json"


@pytest.mark.parametrize("format", ["coco", "yolo-pose"])
def test_keypoints_without_poses_and_camera_are_a_source(format: str, tmp_path: Path) -> None:
    labels = read_labels(foreign(tmp_path / "in"), options=ReadOptions(pixel_origin="corner"))
    out = write_labels(labels, tmp_path / "out", format)
    back = read_labels(out / "annotations.json" if format == "coco" else out, options=ReadOptions(camera=None))
    first, second = sorted(back.records, key=lambda record: record.filename)
    assert first.T_cam_target is None
    np.testing.assert_allclose(first.keypoints_px, [[10.0, 12.0], [30.0, 20.0], [np.nan, np.nan]], atol=1e-8)
    np.testing.assert_array_equal(first.visibility, [2, 1, 0])
    np.testing.assert_allclose(first.box_xyxy, [8.0, 10.0, 38.0, 30.0], atol=1e-8)
    assert second.keypoints_px is None


def test_a_data_set_of_ours_needs_the_poses_that_such_a_file_lacks(labels: Labels, tmp_path: Path) -> None:
    read = ReadOptions(camera=labels.camera, keypoints_m=np.eye(3), pixel_origin="corner")
    with pytest.raises(InputError, match=r"'a.png' has no pose .* --skip-without-pose"):
        write_labels(read_labels(foreign(tmp_path / "in"), options=read), tmp_path / "out", "proxnav")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        ({"keypoints": [1.0, 2.0]}, "n, found 2 numbers"),
        ({"keypoints": [1.0, 2.0, 0.7]}, "scores go to proxnav solve"),
        ({"keypoints": None}, "finite numbers"),
    ],
)
def test_what_is_no_keypoint_label_is_one_sentence(changes: dict[str, Any], found: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=found):
        read_labels(foreign(tmp_path / "in", **changes), options=ReadOptions(pixel_origin="corner"))


def test_boxes_alone_are_refused_and_crowds_are_no_objects(tmp_path: Path) -> None:
    path = foreign(tmp_path / "in")
    content = json.loads(path.read_text())
    content["annotations"].append({"id": 8, "image_id": 5, "category_id": 3, "iscrowd": 1, "bbox": [0, 0, 9, 9]})
    path.write_text(json.dumps(content))
    assert read_labels(path, options=ReadOptions(pixel_origin="corner")).records[0].keypoints_px is not None
    del content["annotations"][0]["keypoints"]
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match="has no keypoints"):
        read_labels(path, options=ReadOptions(pixel_origin="corner"))
