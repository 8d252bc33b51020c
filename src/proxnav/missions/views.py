"""Which views of the target a mission takes beside what its ranges say."""

import math
from functools import lru_cache

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.geometry.arrays import unit
from proxnav.missions.mission import Mission
from proxnav.scenes.random_scene import AcceptView
from proxnav.targets.hull import Hull
from proxnav.targets.loading import load_target

NEAREST_M = 0.3
"""Least distance of a camera to the target's convex hull."""


def accepted_views(mission: Mission, camera: Camera) -> AcceptView | None:
    """Whether a camera outside the target, in the cone of a port, sees enough keypoints; None where all views do."""
    view = mission.view
    if view.least_keypoints <= 0 and not view.port:
        return None
    return _accepted(mission.target, camera, view.least_keypoints, view.port, math.radians(view.cone_deg))


@lru_cache(maxsize=4)
def _accepted(target_name: str, camera: Camera, least: int, port: str, cone_rad: float) -> AcceptView:
    target = load_target(target_name)
    hull = Hull.of(target)
    if port and port not in target.frames:
        raise InputError(f"target {target.name} has no frame '{port}', only {', '.join(target.frames) or 'none'}")
    T_port_target = target.frames[port].inverse() if port else None

    def accept(T_cam_target: Pose) -> bool:
        camera_m = T_cam_target.inverse().t_m
        if hull.distance_m(camera_m) < NEAREST_M:
            return False
        if T_port_target is not None and unit(T_port_target @ camera_m)[0] < math.cos(cone_rad):
            return False
        points = T_cam_target @ target.keypoints_m
        return int((camera.contains(camera.project(points)) & (points[:, 2] > 0.0)).sum()) >= least

    return accept
