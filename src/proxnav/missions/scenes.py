"""The scenes of a mission: drawn one by one from its ranges, or along a trajectory."""

import warnings
from dataclasses import replace
from pathlib import Path

from proxnav.errors import InputError, InputNote
from proxnav.geometry import Camera
from proxnav.missions.daylight import in_light
from proxnav.missions.flights import fly_mission
from proxnav.missions.mission import Mission
from proxnav.missions.views import accepted_views
from proxnav.records import SceneSpec, Trajectory
from proxnav.scenes.from_trajectory import SceneConfig, scene_at
from proxnav.scenes.random_scene import random_scene
from proxnav.trajectories.selection import spread

LARGEST_SIDE_PX = 16_384


def mission_scenes(mission: Mission, frames: int | None, seed: int, size: int | None = None) -> list[SceneSpec]:
    """Scenes along the mission's flight; drawn one by one where it has none.

    Without a number of frames there are as many as the mission says.
    """
    count = mission.frames if frames is None else frames
    if not mission.flight.is_flown:
        return draw_scenes(mission, count, seed, size)
    return follow(fly_mission(mission), mission, count, seed, size)


def draw_scenes(mission: Mission, frames: int, seed: int, size: int | None = None) -> list[SceneSpec]:
    """Scenes of a mission, each a function of (seed, index) alone; `size` resamples the square camera."""
    _check_order(frames, seed)
    camera = resized(mission.camera, size)
    ranges, accept = mission.scenes, accepted_views(mission, camera)
    return [random_scene(index, seed, ranges, mission.target, camera, accept=accept) for index in range(frames)]


def follow(
    trajectory: Trajectory, mission: Mission, frames: int, seed: int, size: int | None = None
) -> list[SceneSpec]:
    """`frames` scenes spread evenly over the part of a trajectory whose light the mission wants.

    InputError where all of it is dark, unless the mission wants eclipse.
    """
    _check_order(frames, seed)
    seen = spread(in_light(trajectory, mission), frames)
    if len(seen) < frames:
        warnings.warn(
            f"{trajectory.source}: {len(seen)} of its {len(trajectory)} instants have the light that the mission "
            f"wants, fewer than the {frames} frames asked for",
            InputNote,
            stacklevel=2,
        )
    camera = resized(mission.camera, size)
    config = SceneConfig(sensor=mission.sensor, cloud_seed=seed, sequence=seen.source)
    return [
        scene_at(seen, k, index=k, target=mission.target, camera=camera, config=config, seed=seed)
        for k in range(len(seen))
    ]


def _check_order(frames: int, seed: int) -> None:
    if frames < 1 or seed < 0:
        raise InputError(f"a set needs at least 1 frame and a seed from 0 on, found {frames} frames and seed {seed}")


def under_clouds(scenes: list[SceneSpec], picture: Path | None) -> list[SceneSpec]:
    """The scenes with a picture's cloud over their Earth, equirectangular, white where opaque; unchanged for None."""
    if picture is None:
        return scenes
    if not picture.is_file():
        raise InputError(f"{picture}: no such file; --clouds names an equirectangular picture of cloud")
    image = str(picture.resolve())
    return [
        scene if scene.earth is None else replace(scene, earth=replace(scene.earth, cloud_image=image))
        for scene in scenes
    ]


def resized(camera: Camera, size: int | None) -> Camera:
    """The camera with its longer side at `size` pixels; unchanged for None."""
    if size is None:
        return camera
    if not 1 <= size <= LARGEST_SIDE_PX:
        raise InputError(f"an image needs 1 to {LARGEST_SIDE_PX} px on its longer side, found {size}")
    scale = size / max(camera.width, camera.height)
    return camera.resized(round(camera.width * scale), round(camera.height * scale))
