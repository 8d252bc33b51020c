"""The scenes of a mission: drawn one by one from its ranges, or along a trajectory."""

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.missions.mission import Mission
from proxnav.records import SceneSpec, Trajectory
from proxnav.scenes.from_trajectory import SceneConfig, scene_at
from proxnav.scenes.random_scene import random_scene
from proxnav.trajectories.selection import observable, select, spread

LARGEST_SIDE_PX = 16_384


def draw_scenes(mission: Mission, frames: int, seed: int, size: int | None = None) -> list[SceneSpec]:
    """Scenes of a mission, each a function of (seed, index) alone; `size` resamples the square camera."""
    _check_order(frames, seed)
    camera = resized(mission.camera, size)
    return [random_scene(index, seed, mission.scenes, mission.target, camera) for index in range(frames)]


def follow(
    trajectory: Trajectory, mission: Mission, frames: int, seed: int, size: int | None = None
) -> list[SceneSpec]:
    """`frames` scenes spread evenly over the observable part of a trajectory; over all of it if there is none."""
    _check_order(frames, seed)
    usable = observable(trajectory, mission.scenes.sun.max_phase_rad)
    seen = spread(select(trajectory, usable) if usable.any() else trajectory, frames)
    camera = resized(mission.camera, size)
    config = SceneConfig(sensor=mission.sensor, cloud_seed=seed, sequence=seen.source)
    return [
        scene_at(seen, k, index=k, target=mission.target, camera=camera, config=config, seed=seed)
        for k in range(len(seen))
    ]


def _check_order(frames: int, seed: int) -> None:
    if frames < 1 or seed < 0:
        raise InputError(f"a set needs at least 1 frame and a seed from 0 on, found {frames} frames and seed {seed}")


def resized(camera: Camera, size: int | None) -> Camera:
    """The camera with its longer side at `size` pixels; unchanged for None."""
    if size is None:
        return camera
    if not 1 <= size <= LARGEST_SIDE_PX:
        raise InputError(f"an image needs 1 to {LARGEST_SIDE_PX} px on its longer side, found {size}")
    scale = size / max(camera.width, camera.height)
    return camera.resized(round(camera.width * scale), round(camera.height * scale))
