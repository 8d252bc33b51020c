"""A pose moved and judged by the view that it predicts: the target ray-cast under the known Sun and Earth."""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import cv2
import numpy as np

from proxnav.geometry import Camera, Pose
from proxnav.geometry.arrays import unit
from proxnav.geometry.celestial import EARTH_MEAN_RADIUS
from proxnav.geometry.types import GreyImage, PoseCovariance
from proxnav.images.crop import Crop, cut
from proxnav.pose.align.photometric import PredictedView, photometric_equations
from proxnav.pose.align.target_crop import target_box
from proxnav.pose.local_contrast import View
from proxnav.pose.trust import Similarity, local_correlation
from proxnav.records import EarthSpec, SceneSpec, Sky, SunSpec, Window
from proxnav.rendering.raycast import RaycastRenderer
from proxnav.rendering.raycast.config import QUICK
from proxnav.scenes.plain import quadruple, triple
from proxnav.targets import Target

SIDE_PX = 224
"""Side of the square in which the likeness of views is measured."""
STEPS = ((SIDE_PX, 2.0), (320, 2.5))
"""Most pixels of the square's side and window [px] of each step that moves the pose; more steps gain little."""
_MARGIN = 1.25
"""Side of the square over the longer side of the target's box."""
_ALTITUDE_M = 400e3
"""Altitude of the target, which sets how much of the sky Earth fills; its light is a rough one anyway."""


@dataclass(frozen=True, slots=True, eq=False)
class Checked:
    """A pose after it was compared with the picture."""

    T_cam_target: Pose
    covariance: PoseCovariance
    similarity: Similarity


class _Views(NamedTuple):
    """The predicted and the seen view in one square, and how alike they are."""

    predicted: PredictedView
    seen: View
    similarity: Similarity


@dataclass(frozen=True)
class Verifier:
    """Compares pictures with predicted views of one target."""

    renderer: RaycastRenderer

    def similarity(self, grey: GreyImage, camera: Camera, T_cam_target: Pose, sky: Sky) -> Similarity | None:
        """Local correlation of the picture with the view that the pose predicts; None where it shows no target."""
        found = self._compared(grey, camera, T_cam_target, sky, SIDE_PX)
        return None if found is None else found.similarity

    def checked(
        self, grey: GreyImage, camera: Camera, T_cam_target: Pose, covariance: PoseCovariance, sky: Sky
    ) -> Checked | None:
        """The pose moved until the view that it predicts lies on the picture; None where it shows no target.

        The similarity is that of the last view that was drawn. A picture that says too little leaves the pose alone.
        """
        pose, similarity, information = T_cam_target, None, np.linalg.inv(covariance)
        for side, window in STEPS:
            found = self._compared(grey, camera, pose, sky, side)
            if found is None:
                return None
            similarity, equations = found.similarity, photometric_equations(found.predicted, found.seen, window)
            if equations is None:
                break
            pose = equations.step(pose, T_cam_target, information)
            covariance = equations.covariance(information)
        return None if similarity is None else Checked(pose, covariance, similarity)

    def _compared(self, grey: GreyImage, camera: Camera, T_cam_target: Pose, sky: Sky, most: int) -> "_Views | None":
        """Both views in a square of at most so many pixels; None where no target is predicted in the picture."""
        box = target_box(self.renderer.target, T_cam_target, camera)
        if box is None:
            return None
        crop = Crop.around(box, _MARGIN)
        side = max(SIDE_PX, min(most, crop.size))
        small = camera.cropped(crop.x, crop.y, crop.size, crop.size).resized(side, side)
        scene = _scene(self.renderer.target.name, camera, T_cam_target, sky)
        frame = self.renderer.render(scene, Window(0, 0, side, side), small)
        seen = cut(grey, crop, side).astype(np.float64)
        inside = cut(np.full(grey.shape, 255, np.uint8), crop, side) > 127
        light, mask = frame.radiance.mean(axis=2).astype(np.float64), (frame.coverage > 0.5) & inside
        view = PredictedView(T_cam_target, small, light, frame.depth_m, mask & np.isfinite(frame.depth_m))
        alike = local_correlation(_shrunk(light), _shrunk(seen), _shrunk(mask.astype(np.float64)) > 0.5)
        return None if alike is None else _Views(view, seen, alike)


def _shrunk(view: View) -> View:
    """The view at the side in which likeness is measured, whatever it was drawn at."""
    return view if len(view) == SIDE_PX else cv2.resize(view, (SIDE_PX, SIDE_PX), interpolation=cv2.INTER_AREA)


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
