"""A wrong order of the quaternion is found by the keypoints, and said."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from boxcraft import CORNERS
from proxnav.datasets.formats import Labels, ReadOptions, read_labels, write_labels
from proxnav.errors import InputError
from proxnav.geometry import Pose
from proxnav.targets.keypoints.point_files import load_points


def spoiled(labels: Labels, change) -> Labels:
    """The same labels with other quaternions and the keypoints as they were."""

    def one(record):
        T = record.T_cam_target
        return replace(record, T_cam_target=Pose.from_wxyz("cam", "target", change(T.q_wxyz), T.t_m))

    return replace(labels, records=tuple(map(one, labels.records)))


@pytest.mark.parametrize("format", ["proxnav", "krn", "spnv2"])
def test_scalar_last_in_a_scalar_first_format_is_named_and_can_be_read(
    format: str, labels: Labels, tmp_path: Path
) -> None:
    out = write_labels(spoiled(labels, lambda q: np.roll(q, -1)), tmp_path / "out", format)
    source = out if format == "proxnav" else next(out.rglob("train.csv"))
    options = ReadOptions(keypoints_m=CORNERS)
    with pytest.raises(InputError, match="--quaternion-order xyzw") as caught:
        read_labels(source, options=options)
    assert str(source) in str(caught.value)
    assert "\n" not in str(caught.value)
    if format != "proxnav":
        record = read_labels(source, options=replace(options, quaternion_order="xyzw")).records[0]
        assert np.abs(record.T_cam_target.q_wxyz @ labels.records[0].T_cam_target.q_wxyz) == pytest.approx(1.0)


def test_the_right_order_called_wrong_is_refused_as_well(labels: Labels, tmp_path: Path) -> None:
    out = write_labels(labels, tmp_path / "out", "krn")
    options = ReadOptions(keypoints_m=CORNERS, quaternion_order="xyzw")
    with pytest.raises(InputError, match="--quaternion-order wxyz"):
        read_labels(next(out.rglob("train.csv")), options=options)


def test_inverted_attitudes_are_called_inverted(labels: Labels, tmp_path: Path) -> None:
    out = write_labels(spoiled(labels, lambda q: q * (1.0, -1.0, -1.0, -1.0)), tmp_path / "out", "krn")
    with pytest.raises(InputError, match="inverted"):
        read_labels(next(out.rglob("train.csv")), options=ReadOptions(keypoints_m=CORNERS))


def test_poses_that_nothing_can_judge_are_read_as_their_format_says(labels: Labels, tmp_path: Path) -> None:
    out = write_labels(spoiled(labels, lambda q: np.roll(q, -1)), tmp_path / "out", "spec2019")
    assert len(read_labels(out / "submission.csv")) == len(labels)


def test_labels_of_an_imperfect_detector_are_not_called_a_wrong_order(
    labels: Labels, tmp_path: Path, rng: np.random.Generator
) -> None:
    noisy = tuple(
        replace(record, keypoints_px=record.keypoints_px + rng.normal(size=(8, 2)), box_xyxy=None)
        for record in labels.records[:2]
    )
    out = write_labels(replace(labels, records=noisy), tmp_path / "out", "krn")
    assert len(read_labels(next(out.rglob("train.csv")), options=ReadOptions(keypoints_m=CORNERS))) == 2


def test_labels_of_the_field_pass_and_turned_ones_do_not(shared_data: Path, tmp_path: Path) -> None:
    """SHIRT ROE1 through the tables of the SPEED+ baseline and of SPNv2, with Tango's points and the SPEED+ camera."""
    speedplus = shared_data / "speedplus"
    points = load_points(speedplus / "tangoPoints.mat")[0]
    few = json.loads((speedplus / "shirt_roe1.json").read_text())["poses"][::300]
    (tmp_path / "roe1.json").write_text(json.dumps({"poses": few}))
    options = ReadOptions(keypoints_m=points)
    (tmp_path / "camera.json").write_text((speedplus / "camera.json").read_text())
    labels = read_labels(tmp_path / "roe1.json", options=options)
    for format in ("krn", "spnv2"):
        table = next(write_labels(labels, tmp_path / format, format).rglob("train.csv"))
        assert read_labels(table, options=options).records[0].keypoints_px.shape == (11, 2)
        lines = [line.split(",") for line in table.read_text().splitlines()]
        turned = [[*cells[:5], *cells[6:9], cells[5], *cells[9:]] for cells in lines]
        table.write_text("\n".join(",".join(cells) for cells in turned))
        with pytest.raises(InputError, match="xyzw"):
            read_labels(table, options=options)
