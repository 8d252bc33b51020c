"""A pose checked by the view that it predicts: the target ray-cast at the pose under the known Sun and Earth."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from proxnav.geometry import Camera, Pose
from proxnav.geometry.arrays import unit
from proxnav.geometry.celestial import EARTH_MEAN_RADIUS
from proxnav.geometry.types import GreyImage
from proxnav.images.crop import Crop, cut
from proxnav.pose.align.target_crop import target_box
from proxnav.pose.trust import Similarity, local_correlation
from proxnav.records import EarthSpec, SceneSpec, Sky, SunSpec, Window
from proxnav.rendering.raycast import RaycastRenderer
from proxnav.rendering.raycast.config import QUICK
from proxnav.scenes.plain import quadruple, triple
from proxnav.targets import Target

SIDE_PX = 224
"""Side of the square in which the views are compared."""
_MARGIN = 1.25
"""Side of the square over the longer side of the target's box."""
_ALTITUDE_M = 400e3
"""Altitude of the target, which sets how much of the sky Earth fills; its light is a rough one anyway."""


@dataclass(frozen=True)
class Verifier:
    """Compares pictures with predicted views of one target."""

    renderer: RaycastRenderer

    def similarity(self, grey: GreyImage, camera: Camera, T_cam_target: Pose, sky: Sky) -> Similarity | None:
        """Local correlation of the picture with the view that the pose predicts; None where it shows no target."""
        box = target_box(self.renderer.target, T_cam_target, camera)
        if box is None:
            return None
        crop = Crop.around(box, _MARGIN)
        small = camera.cropped(crop.x, crop.y, crop.size, crop.size).resized(SIDE_PX, SIDE_PX)
        scene = _scene(self.renderer.target.name, camera, T_cam_target, sky)
        frame = self.renderer.render(scene, Window(0, 0, SIDE_PX, SIDE_PX), small)
        seen = cut(grey, crop, SIDE_PX).astype(np.float64)
        inside = cut(np.full(grey.shape, 255, np.uint8), crop, SIDE_PX) > 127
        return local_correlation(frame.radiance.mean(axis=2).astype(np.float64), seen, (frame.coverage > 0.5) & inside)


@lru_cache(maxsize=4)
def verifier_of(target: Target) -> Verifier:
    """The verifier of a target, which draws at the quality of training crops; it is built once."""
    return Verifier(RaycastRenderer(target, QUICK))


def _scene(target: str, camera: Camera, T_cam_target: Pose, sky: Sky) -> SceneSpec:
    to_target = T_cam_target.inverse().R
    earth = None
    if sky.nadir_cam is not None:
        r_target_earth = (EARTH_MEAN_RADIUS + _ALTITUDE_M) * (to_target @ unit(sky.nadir_cam))
        earth = EarthSpec(triple(r_target_earth), (1.0, 0.0, 0.0, 0.0))
    return SceneSpec(
        index=0,
        target=target,
        camera=camera,
        q_cam_target=quadruple(T_cam_target.q_wxyz),
        t_cam_target_m=triple(T_cam_target.t_m),
        sun=SunSpec(triple(to_target @ unit(sky.sun_cam)), sky.sun_visible),
        earth=earth,
    )
