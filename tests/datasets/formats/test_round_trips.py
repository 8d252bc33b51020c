"""Every format gives back what it can hold, to the last digit."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from proxnav.datasets.formats import (
    READERS,
    WRITERS,
    LabelRecord,
    Labels,
    ReadOptions,
    WriteOptions,
    read_labels,
    read_pose_records,
    write_labels,
)
from proxnav.datasets.formats.bop_write import decode_depth, depth_scale_mm, encode_depth
from proxnav.datasets.set.dataset import Dataset
from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose

TABLES = {
    "krn": ("synthetic/splits_krn/train.csv", "synthetic/splits_krn/validation.csv"),
    "spnv2": ("synthetic/labels/train.csv", "synthetic/labels/validation.csv"),
    "spec2019": ("submission.csv",),
    "spec2021": ("submission.csv",),
    "spark": ("poses.csv",),
    "bop-results": ("results.csv",),
    "poses": ("poses.json",),
    "coco": ("annotations.json",),
    "detectron2": ("annotations.json",),
}
WITH_IMAGES = ("proxnav", "coco", "detectron2", "yolo-pose", "speed", "speed+", "urso", "krn", "spnv2", "spark", "bop")
WITH_MASKS = ("proxnav", "coco", "detectron2", "yolo-pose", "speed+", "krn", "spnv2", "bop")
WITH_ALL_KEYPOINTS = ("proxnav", "coco", "detectron2", "krn", "spnv2")
WITH_KEYPOINTS = (*WITH_ALL_KEYPOINTS, "yolo-pose")
WITH_CAMERA = (
    "proxnav",
    "coco",
    "detectron2",
    "yolo-pose",
    "speed",
    "speed+",
    "poses",
    "urso",
    "krn",
    "spnv2",
    "spark",
    "bop",
)


def again(folder: Path, format: str, name: str = "auto") -> dict[str, LabelRecord]:
    """All records that a conversion wrote, by file name."""
    sources = [folder / table for table in TABLES[format]] if format in TABLES else [folder]
    found = [record for source in sources for record in read_labels(source, name).records]
    assert len({record.filename for record in found}) == len(found)
    return {record.filename: record for record in found}


@pytest.mark.parametrize("format", [name for name in WRITERS if name not in ("bop-results", "tum")])
def test_poses_images_and_labels_come_back(format: str, labels: Labels, tmp_path: Path) -> None:
    out = write_labels(labels, tmp_path / "out", format, WriteOptions(split="lightbox" if format == "spec2021" else ""))
    found = again(out, format)
    assert sorted(found) == sorted(record.filename for record in labels.records)
    for record in labels.records:
        back = found[record.filename]
        np.testing.assert_allclose(back.T_cam_target.matrix(), record.T_cam_target.matrix(), rtol=0, atol=1e-9)
        if format in WITH_IMAGES:
            assert back.image.read_bytes() == record.image.read_bytes()
        if format in WITH_MASKS:
            assert back.mask.read_bytes() == record.mask.read_bytes()
            if format not in ("speed+", "yolo-pose"):  # the latter cuts boxes at the edges
                np.testing.assert_allclose(back.box_xyxy, record.box_xyxy, rtol=0, atol=1e-9)
        if format in WITH_ALL_KEYPOINTS:
            np.testing.assert_allclose(back.keypoints_px, record.keypoints_px, rtol=0, atol=1e-9)


@pytest.mark.parametrize("format", WITH_CAMERA)
def test_the_camera_comes_back(format: str, labels: Labels, tmp_path: Path) -> None:
    out = write_labels(labels, tmp_path / "out", format)
    source = out / TABLES[format][0] if format in TABLES else out
    assert read_labels(source).camera == labels.camera


def test_a_format_named_by_its_name_reads_as_the_recognised_one(labels: Labels, tmp_path: Path) -> None:
    for format in [name for name in WRITERS if name != "tum"]:  # whose records are known by their times
        out = write_labels(labels, tmp_path / format, format, WriteOptions(split="lightbox"))
        source = out / TABLES[format][0] if format in TABLES and format not in ("krn", "spnv2") else out
        if format in ("krn", "spnv2"):
            source = next(out.rglob("*.csv"))
        named, recognised = read_labels(source, format), read_labels(source)
        assert [r.filename for r in named.records] == [r.filename for r in recognised.records]


def test_ours_through_speedplus_is_ours_again(labels: Labels, tmp_path: Path) -> None:
    tree = write_labels(labels, tmp_path / "tree", "speed+")
    back = Dataset(write_labels(read_labels(tree), tmp_path / "back", "proxnav"))
    with pytest.raises(InputError, match="only sets that proxnav rendered"):
        next(back.scenes())
    originals = {record.filename: record for record in labels.records}
    np.testing.assert_array_equal(back.keypoints_m, labels.keypoints_m)
    for index, label in enumerate(back.labels):
        original = originals[label.filename]
        np.testing.assert_allclose(label.keypoints_px, original.keypoints_px, atol=1e-9)
        np.testing.assert_allclose(label.T_cam_target.matrix(), original.T_cam_target.matrix(), atol=1e-9)
        assert back.image(index).shape == (48, 64)
        assert back.mask(index).sum() > 0


def test_visibility_and_covariances_come_back_where_there_is_room(labels: Labels, tmp_path: Path) -> None:
    coco = again(write_labels(labels, tmp_path / "coco", "proxnav"), "proxnav")
    for record in labels.records:
        np.testing.assert_array_equal(coco[record.filename].visibility, record.visibility)
    covariance = np.diag(np.arange(1.0, 7.0)) / 3.0
    estimates = replace(labels, records=tuple(replace(r, covariance=covariance) for r in labels.records[:-1]))
    lost = replace(labels.records[-1], T_cam_target=None, status="no_target")
    estimates = replace(estimates, records=(*estimates.records, lost))
    found = read_pose_records(write_labels(estimates, tmp_path / "poses", "poses") / "poses.json")
    assert found[lost.filename].T_cam_target is None
    assert found[lost.filename].status == "no_target"
    np.testing.assert_array_equal(found[labels.records[0].filename].covariance, covariance)


def test_bop_results_come_back_by_number_and_leave_out_what_has_no_pose(labels: Labels, tmp_path: Path) -> None:
    lost = replace(labels.records[2], T_cam_target=None, status="no_target")
    estimates = replace(labels, records=(*labels.records[:2], lost, *labels.records[3:]))
    found = again(write_labels(estimates, tmp_path / "out", "bop-results"), "bop-results")
    assert len(found) == len(labels) - 1
    for record in (*labels.records[:2], *labels.records[3:]):
        back = found[record.filename.replace("img", "")]
        np.testing.assert_allclose(back.T_cam_target.matrix(), record.T_cam_target.matrix(), rtol=0, atol=1e-9)


def test_a_format_that_cannot_say_no_pose_refuses(labels: Labels, tmp_path: Path) -> None:
    lost = replace(labels.records[0], T_cam_target=None, status="no_consensus")
    for format in ("speed+", "speed", "urso", "krn", "spnv2", "spec2019", "spark"):
        with pytest.raises(InputError, match="no_consensus"):
            write_labels(replace(labels, records=(lost, *labels.records[1:])), tmp_path / format, format)


def test_parts_of_a_set_stay_apart(labels: Labels, tmp_path: Path) -> None:
    parts = ("synthetic/train", "synthetic/validation", "lightbox/test", "sunlamp/test")
    records = tuple(
        replace(record, filename="img.png", split=part) for record, part in zip(labels.records, parts, strict=False)
    )
    found = read_labels(write_labels(replace(labels, records=records[:4]), tmp_path / "out", "speed+"))
    assert {record.split for record in found.records} == set(parts)
    assert len({record.filename for record in found.records}) == 4
    by_split = {record.split: record for record in found.records}
    for record in records[:4]:
        np.testing.assert_array_equal(by_split[record.split].T_cam_target.t_m, record.T_cam_target.t_m)
        assert by_split[record.split].image.read_bytes() == record.image.read_bytes()


def test_a_hard_link_shares_the_bytes_and_a_copy_does_not(labels: Labels, tmp_path: Path) -> None:
    for images, same in (("link", True), ("copy", False)):
        out = write_labels(labels, tmp_path / images, "coco", WriteOptions(images=images))
        assert (out / "images" / labels.records[0].filename).samefile(labels.records[0].image) == same
    assert not (write_labels(labels, tmp_path / "none", "coco", WriteOptions(images="none")) / "images").exists()


def test_a_folder_that_holds_something_is_not_written_into(labels: Labels, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.tex").write_text("dear reader")
    with pytest.raises(InputError, match="not an empty folder"):
        write_labels(labels, tmp_path / "out", "speed+")


def test_a_conversion_that_fails_leaves_nothing_behind(labels: Labels, tmp_path: Path) -> None:
    lost = replace(labels.records[-1], T_cam_target=None, status="no_target")
    before = sorted(tmp_path.iterdir())
    with pytest.raises(InputError, match="no_target"):
        write_labels(replace(labels, records=(*labels.records[:-1], lost)), tmp_path / "out", "speed+")
    assert sorted(tmp_path.iterdir()) == before
    (tmp_path / "out").mkdir()
    assert len(read_labels(write_labels(labels, tmp_path / "out", "speed+"))) == len(labels)


def test_reading_and_writing_know_the_same_formats() -> None:
    assert set(READERS) - set(WRITERS) == {"shirt", "solution"}


@given(st.floats(0.5, 5000.0))
def test_depth_of_any_range_comes_back_within_half_a_step(far_m: float) -> None:
    record = LabelRecord("0.png", Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [0.0, 0.0, far_m]))
    scale = depth_scale_mm(Labels((record,)))
    depth = np.array([[far_m, far_m / 2.0, np.nan]])
    back = decode_depth(encode_depth(depth, scale), scale)
    np.testing.assert_allclose(back[0, :2], depth[0, :2], rtol=0, atol=0.5e-3 * scale + 1e-9)
    assert np.isnan(back[0, 2])


def test_depth_beyond_16_bits_is_refused_and_not_clipped() -> None:
    with pytest.raises(InputError, match="16 bits"):
        encode_depth(np.array([[66.0]]), 1.0)


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from([n for n in WRITERS if n not in (*WITH_KEYPOINTS, "tum")]), st.data())
def test_any_pose_comes_back(tmp_path_factory: pytest.TempPathFactory, format: str, data: st.DataObject) -> None:
    q = np.array(data.draw(st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4)))
    t = np.array(data.draw(st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3)))
    if np.linalg.norm(q) < 0.1:
        q = np.array([1.0, 0.0, 0.0, 0.0])
    if format == "bop" and np.linalg.norm(t) < 0.15:
        t[2] += 1.0  # nearer ones are taken for metres
    T = Pose.from_wxyz("cam", "target", q / np.linalg.norm(q), t)
    camera = Camera(64, 48, 60.0, 61.0, 32.0, 24.0)
    out = write_labels(
        Labels((LabelRecord("7.png", T, split="lightbox"),), camera), tmp_path_factory.mktemp("any") / "out", format
    )
    name = "spec2019" if format == "spec2019" else "auto"
    source = out / TABLES[format][0] if format in TABLES else out
    (back,) = read_labels(source, name, ReadOptions(camera=camera)).records
    np.testing.assert_allclose(back.T_cam_target.matrix(), T.matrix(), rtol=0, atol=1e-9)
