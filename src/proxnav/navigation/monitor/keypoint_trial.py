"""Poses against the keypoints of their own frames: how far from its pixels each pose puts the target's points."""

import numpy as np

from proxnav.geometry import quaternion
from proxnav.navigation.monitor.account import AGREES, NOT_COMPARED, UNEXPLAINED, Account
from proxnav.navigation.monitor.scene import PoseConvention, Scene

KIND = "poses against keypoints"
_LEAST_FRAMES = 10
_FAR_PX, _FAR_SIGMAS = 10.0, 4.0
"""A pose misses its frame where the median keypoint lies farther off than both."""


def keypoint_account(scene: Scene, pose: PoseConvention) -> Account:
    """Whether poses and keypoints show the same target."""
    window, setup = scene.window, scene.setup
    at = {float(t): k for k, t in enumerate(window.pose_t)}
    frames = [(frame, at[frame.t]) for frame in window.frames if frame.t in at]
    if len(frames) < _LEAST_FRAMES:
        return NOT_COMPARED
    off = []
    for frame, k in frames:
        q, t = pose.read(window.q_pose[k], window.position[k])
        pixels = setup.camera.project(setup.points_m[: len(frame.pixels)] @ quaternion.to_matrix(q).T + t)
        miss = np.linalg.norm(frame.pixels - pixels, axis=1)
        sigma = np.sqrt(np.trace(frame.covariances_px2, axis1=1, axis2=2))
        found = np.isfinite(frame.pixels[:, 0])
        miss = np.where(np.isfinite(miss), miss, np.inf)[found]
        off.append(found.any() and np.median(miss) > max(_FAR_PX, _FAR_SIGMAS * np.median(sigma[found])))
    if np.mean(off) < 0.7:
        return AGREES
    return Account(UNEXPLAINED, KIND, "poses and keypoints of the same frames contradict each other")
