"""What the weights in the package do: the study's accuracy on fresh frames, and no pose where there is no target."""

from dataclasses import replace

import numpy as np
import pytest

from proxnav.estimator import PoseEstimator
from proxnav.evaluation.error_tables import STUDY
from proxnav.frames import FrameConfig, FrameJob
from proxnav.geometry.pose_errors import pose_errors
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes

FRAMES = 16
MISSION = load_mission("observation-10-100m")


@pytest.fixture(scope="module")
def estimator():
    return PoseEstimator.load("space-rider", "onnxruntime")


@pytest.fixture(scope="module")
def make():
    return FrameJob("space-rider", FrameConfig("raycast"))()


def test_fresh_frames_are_seen_as_well_as_the_study_saw_its_own(estimator, make):
    errors = []
    for scene in draw_scenes(MISSION, FRAMES, seed=424_242):
        T = estimator(make(scene).image, scene.camera).T_cam_target
        if T is not None:
            errors.append(pose_errors(T, scene.T_cam_target).e_c)
    assert len(errors) >= 0.8 * FRAMES
    assert np.median(errors) < STUDY["mean_e_c"]


def test_sky_and_earth_without_a_target_give_no_pose(estimator, make):
    for scene in draw_scenes(MISSION, FRAMES, seed=515_151):
        empty = replace(scene, t_cam_target_m=(0.0, 0.0, -50.0))  # behind the camera
        assert estimator(make(empty).image, scene.camera).T_cam_target is None


def test_an_outline_that_the_image_does_not_show_takes_the_pose_back(estimator, make):
    scene = next(iter(draw_scenes(MISSION, 1, seed=424_242)))
    image = make(scene).image
    found = estimator.alignment_of(image, scene.camera)
    for least, status in ((found.edge_share - 1e-6, "ok"), (found.edge_share + 1e-6, "no_consensus")):
        strict = replace(estimator, alignment=replace(estimator.alignment, least_edge_share=least))
        result = strict(image, scene.camera)
        assert (result.status, result.T_cam_target is None) == (status, status != "ok")


@pytest.mark.parametrize("kind", ["white", "smooth"])
def test_noise_gives_no_pose(estimator, kind, rng):
    import cv2

    for _ in range(4):
        image = rng.integers(0, 256, (1024, 1024), dtype=np.uint8)
        if kind == "smooth":
            image = cv2.normalize(cv2.GaussianBlur(image, (0, 0), 12.0), None, 0, 255, cv2.NORM_MINMAX)
        assert estimator(image, MISSION.camera).T_cam_target is None


def test_the_studys_network_sees_as_well_as_the_study_did(make):
    study = PoseEstimator.load("space-rider-study")
    errors = []
    for scene in draw_scenes(MISSION, FRAMES, seed=424_242):
        T = study(make(scene).image, scene.camera).T_cam_target
        if T is not None:
            errors.append(pose_errors(T, scene.T_cam_target).e_c)
    assert len(errors) >= 0.6 * FRAMES
    assert np.median(errors) < STUDY["mean_e_c"]
