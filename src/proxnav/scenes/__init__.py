"""What the camera looks at: scenes from a trajectory's instants, or drawn at random."""

from proxnav.scenes.from_trajectory import SceneConfig, scene_at
from proxnav.scenes.random_scene import RandomSceneConfig, random_scene
from proxnav.scenes.random_sun import SunConfig
from proxnav.scenes.random_view import ViewpointConfig

__all__ = ["RandomSceneConfig", "SceneConfig", "SunConfig", "ViewpointConfig", "random_scene", "scene_at"]
