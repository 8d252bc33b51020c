"""Keypoints that were read wrongly are refused with the cause; honest ones with outliers are not."""

import numpy as np
import pytest
from tests.pose.solve.cases import CAMERA, many, random_pose

from proxnav.geometry import Pose, quaternion
from proxnav.pose.solve.chance import residual_chance
from proxnav.pose.solve.estimate import estimate_pose
from proxnav.targets.loading import load_target

POINTS = load_target("space-rider").keypoints_m


def noisy_view(seed: int, outliers: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    pixels = CAMERA.project(random_pose(rng) @ POINTS) + rng.normal(size=(len(POINTS), 2))
    pixels[rng.permutation(len(POINTS))[:outliers]] = rng.uniform(0.0, 1024.0, (outliers, 2))
    return pixels


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("outliers", [0, 2])
def test_mirror_images_and_exchanged_axes_are_named(seed: int, outliers: int) -> None:
    pixels = noisy_view(seed, outliers)
    from_right, exchanged = pixels * [-1.0, 1.0] + [1024.0, 0.0], pixels[:, ::-1]
    for wrong in (from_right, exchanged):
        result = estimate_pose(POINTS, wrong, CAMERA)
        assert result.status in ("mirrored_points", "behind_camera")
        assert result.T_cam_target is None


def test_shares_of_the_image_are_no_pixels() -> None:
    assert estimate_pose(POINTS, noisy_view(1) / 1024.0, CAMERA).status == "other_pixels"


def test_pixels_of_a_crop_are_named_where_perspective_tells_them() -> None:
    statuses = []
    for seed in range(2, 14):
        near = random_pose(np.random.default_rng(seed), 14.0, 18.0)
        pixels = CAMERA.project(near @ POINTS)
        low = pixels.min(axis=0)
        statuses.append(estimate_pose(POINTS, (pixels - low) * 256.0 / (pixels - low).max(), CAMERA).status)
    assert statuses.count("other_pixels") >= 10


def test_honest_points_in_the_corner_of_the_image_are_accepted() -> None:
    rng = np.random.default_rng(5)
    for _ in range(60):
        away = CAMERA.unproject(rng.uniform(90.0, 130.0, 2)) * rng.uniform(60.0, 100.0)
        T = Pose.from_wxyz("cam", "target", quaternion.random(rng, 1)[0], away)
        pixels = CAMERA.project(T @ POINTS) + rng.normal(size=(len(POINTS), 2))
        assert estimate_pose(POINTS, pixels, CAMERA).status != "other_pixels"


@pytest.mark.parametrize("share", [0.2, 0.4])
def test_occluded_points_anywhere_do_not_make_a_mirror_image(share: float) -> None:
    rng = np.random.default_rng(6)
    for k in range(100):
        points = many(24) if k % 2 else POINTS
        pixels = CAMERA.project(random_pose(rng) @ points) + rng.normal(size=(24, 2))
        wrong = rng.random(24) < share
        pixels[wrong] = rng.uniform(0.0, 1024.0, (wrong.sum(), 2))
        assert estimate_pose(points, pixels, CAMERA).status in ("ok", "no_consensus")


def test_p_values_of_honest_keypoints_are_spread_and_those_of_wrong_claims_are_small() -> None:
    rng = np.random.default_rng(7)
    honest, bold = [], []
    for _ in range(150):
        pixels = CAMERA.project(random_pose(rng) @ POINTS) + rng.normal(size=(24, 2))
        for values, sigma in ((honest, 1.0), (bold, 0.6)):
            values.append(estimate_pose(POINTS, pixels, CAMERA, np.tile(sigma**2 * np.eye(2), (24, 1, 1))).p_value)
    assert np.mean(np.array(honest) < 0.05) < 0.1
    assert np.median(honest) > 0.3
    assert np.median(bold) < 1e-3


def test_the_chance_falls_with_every_outlier() -> None:
    d2 = np.full(24, 2.0)
    chances = [residual_chance(d2, np.arange(24) >= k, noise_unknown=True) for k in range(12)]
    assert chances[0] == 1.0
    assert (np.diff(chances) < 0.0).all()
