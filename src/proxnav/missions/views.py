"""Which views of the target a mission takes beside what its ranges say."""

from functools import lru_cache

from proxnav.geometry import Camera, Pose
from proxnav.missions.mission import Mission
from proxnav.scenes.random_scene import AcceptView
from proxnav.targets.hull import Hull
from proxnav.targets.loading import load_target

NEAREST_M = 0.3
"""Least distance of a camera to the target's convex hull."""


def accepted_views(mission: Mission, camera: Camera) -> AcceptView | None:
    """Whether enough keypoints lie in the picture of a camera outside the target; None where the mission takes all."""
    least = mission.view.least_keypoints
    return _accepted(mission.target, camera, least) if least > 0 else None


@lru_cache(maxsize=4)
def _accepted(target_name: str, camera: Camera, least: int) -> AcceptView:
    target = load_target(target_name)
    hull = Hull.of(target)

    def accept(T_cam_target: Pose) -> bool:
        if hull.distance_m(T_cam_target.inverse().t_m) < NEAREST_M:
            return False
        points = T_cam_target @ target.keypoints_m
        return int((camera.contains(camera.project(points)) & (points[:, 2] > 0.0)).sum()) >= least

    return accept
