"""Labels whose keypoints contradict their poses are refused by their cause, and honest ones are not."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from boxcraft import CORNERS
from proxnav.cli.main import main
from proxnav.datasets.formats import LabelRecord, Labels, ReadOptions, read_labels, write_labels
from proxnav.datasets.formats.consistency import check_consistency
from proxnav.datasets.formats.point_recovery import recovered
from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose, quaternion

CAMERA = Camera(640, 480, 700.0, 710.0, 320.0, 240.0, (-0.1, 0.02, 0.0, 0.001, 0.0))
SIZE = np.array([640.0, 480.0])
OPENGL = Pose.from_wxyz("cam", "cam", [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0])


@pytest.fixture
def honest(rng: np.random.Generator) -> Labels:
    """Twelve frames of the test box, 6 m to 30 m away."""
    records = []
    for k, q in enumerate(quaternion.random(rng, 12)):
        z = 6.0 + 2.0 * k
        T = Pose.from_wxyz("cam", "target", q, [0.05 * z, -0.04 * z, z])
        records.append(LabelRecord(f"img{k:03d}.png", T, keypoints_px=CAMERA.project(T @ CORNERS)))
    return Labels(tuple(records), CAMERA, CORNERS)


def changed(labels: Labels, change: Callable[[LabelRecord], LabelRecord]) -> Labels:
    return replace(labels, records=tuple(map(change, labels.records)))


def with_pose(change: Callable[[Pose], Pose]) -> Callable[[LabelRecord], LabelRecord]:
    return lambda record: replace(record, T_cam_target=change(record.T_cam_target))


def with_pixels(change: Callable[[np.ndarray], np.ndarray]) -> Callable[[LabelRecord], LabelRecord]:
    return lambda record: replace(record, keypoints_px=change(record.keypoints_px))


def moved(factor: float) -> Callable[[LabelRecord], LabelRecord]:
    return with_pose(lambda T: Pose("cam", "target", T.q_wxyz, T.t_m * factor))


def inverted(T: Pose) -> Pose:
    T = T.inverse()
    return Pose("cam", "target", T.q_wxyz, T.t_m)


CONTRADICTIONS = {
    "scalar last": (with_pose(lambda T: Pose("cam", "target", np.roll(T.q_wxyz, -1), T.t_m)), "-order xyzw"),
    "transposed": (with_pose(lambda T: Pose("cam", "target", T.q_wxyz * (1, -1, -1, -1), T.t_m)), "transposed"),
    "inverted": (with_pose(inverted), "whole poses are inverted"),
    "opengl": (with_pose(lambda T: OPENGL @ T), "OpenGL"),
    "millimetres": (moved(1000.0), "positions are in mm"),
    "centimetres": (moved(100.0), "positions are in cm"),
    "points in millimetres": (moved(1e-3), "target's points are in mm"),
    "normalised": (with_pixels(lambda p: p / SIZE), "parts of the image's size"),
    "exchanged": (with_pixels(lambda p: p[:, ::-1]), "x and y are exchanged"),
    "mirrored": (with_pixels(lambda p: p * (-1, 1) + (640.0, 0.0)), "from the right"),
    "upside down": (with_pixels(lambda p: p * (1, -1) + (0.0, 480.0)), "from the bottom"),
    "half size": (with_pixels(lambda p: 0.5 * p), "another size"),
    "crop": (with_pixels(lambda p: (p - p.min(axis=0) + 5.0) * 1.3), "pixels of a crop"),
    "scale": (moved(1.1), "of another scale"),
    "order": (with_pixels(lambda p: p[[1, 0, 2, 3, 6, 5, 4, 7]]), "order of the points"),
}  # fmt: skip


@pytest.mark.parametrize(("change", "cause"), CONTRADICTIONS.values(), ids=CONTRADICTIONS)
def test_a_contradiction_is_refused_with_its_cause(change: Callable, cause: str, honest: Labels) -> None:
    check_consistency(honest, "wxyz", "labels")
    with pytest.raises(InputError, match=cause) as error:
        check_consistency(changed(honest, change), "wxyz", "labels")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("kind", ["scalar last", "transposed", "mirrored", "exchanged", "normalised"])
def test_without_3d_points_the_pixels_of_several_images_contradict_as_well(kind: str, honest: Labels) -> None:
    unknown = replace(honest, keypoints_m=None)
    check_consistency(unknown, "wxyz", "labels")
    with pytest.raises(InputError):
        check_consistency(changed(unknown, CONTRADICTIONS[kind][0]), "wxyz", "labels")


def test_one_wrong_image_among_many_is_named(honest: Labels) -> None:
    wrong = with_pixels(lambda p: p + 40.0)(honest.records[7])
    labels = replace(honest, records=(*honest.records[:7], wrong, *honest.records[8:]))
    with pytest.raises(InputError, match=r"1 of 12 images .* 'img007.png' by 56.6 px"):
        check_consistency(labels, "wxyz", "labels")


def test_noise_of_a_detector_and_points_that_nobody_saw_are_no_contradiction(
    honest: Labels, rng: np.random.Generator
) -> None:
    noisy = changed(honest, with_pixels(lambda p: p + rng.normal(scale=1.0, size=p.shape)))
    check_consistency(noisy, "wxyz", "labels")
    unseen = with_pixels(lambda p: np.where(np.arange(8)[:, None] < 3, np.nan, p))
    check_consistency(changed(noisy, unseen), "wxyz", "labels")
    nothing = with_pixels(lambda p: np.full_like(p, np.nan))
    check_consistency(changed(honest, nothing), "wxyz", "labels")


def test_another_number_of_points_is_another_target(honest: Labels) -> None:
    with pytest.raises(InputError, match="has 8 keypoints and the target 7"):
        check_consistency(replace(honest, keypoints_m=CORNERS[:7], keypoint_names=()), "wxyz", "labels")


def test_points_come_back_from_pixels_and_poses(honest: Labels) -> None:
    R = np.array([record.T_cam_target.R for record in honest.records])
    t_m = np.array([record.T_cam_target.t_m for record in honest.records])
    pixels = np.array([record.keypoints_px for record in honest.records])
    np.testing.assert_allclose(recovered(CAMERA, R, t_m, pixels), CORNERS, atol=1e-6)  # m
    assert recovered(CAMERA, R[:3], t_m[:3], pixels[:3]) is None
    still = [np.repeat(a[:1], 6, axis=0) for a in (R, t_m, pixels)]
    assert recovered(CAMERA, *still) is None


def test_nothing_is_written_of_contradicting_labels(
    honest: Labels, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    mirrored = changed(honest, CONTRADICTIONS["mirrored"][0])
    table = next(write_labels(mirrored, tmp_path / "krn", "krn").rglob("train.csv"))
    for to in ("coco", "speed+", "poses"):
        assert main(["convert", str(table), "--to", to, "--out", str(tmp_path / "out")]) == 1
        assert "from the right" in capsys.readouterr().err
        assert not (tmp_path / "out").exists()
    assert main(["evaluate", str(table), str(table)]) == 1


def test_a_list_with_keypoints_and_poses_becomes_a_data_set_without_a_target(honest: Labels, tmp_path: Path) -> None:
    """KRN's and SPNv2's lists lack 3-D points: they follow from the pixels and are not asked for."""
    table = next(write_labels(honest, tmp_path / "krn", "krn").rglob("train.csv"))
    with pytest.warns(UserWarning, match="8 points of the target are found from the pixels of 10 images"):
        out = write_labels(read_labels(table), tmp_path / "out", "proxnav")
    back = read_labels(out)
    np.testing.assert_allclose(back.keypoints_m, CORNERS, atol=1e-6)
    coco = write_labels(read_labels(table), tmp_path / "coco", "coco")
    options = ReadOptions(keypoints_m=CORNERS)
    assert len(read_labels(coco / "annotations.json", options=options)) == 10
