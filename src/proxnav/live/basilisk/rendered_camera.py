"""A camera on the chaser that sees the target: both states and the Sun in, an encoded image out."""

import time
from typing import Any

import numpy as np

from proxnav.geometry.arrays import unit
from proxnav.geometry.epochs import parse_iso
from proxnav.geometry.types import Image, Vector3
from proxnav.images.codecs import encode_png
from proxnav.live.basilisk.body_states import camera_state, craft_state
from proxnav.live.basilisk.camera_config import camera_of, mounting_of
from proxnav.live.basilisk.image_message import KeptImage
from proxnav.live.basilisk.installed import NANO, linked, messaging, sysModel
from proxnav.rendering.raycast import RaycastConfig, RaycastRenderer
from proxnav.scenes.from_states import scene_from_states
from proxnav.scenes.from_trajectory import SceneConfig
from proxnav.sensor.expose import expose
from proxnav.sensor.presets import SPEED_CLASS
from proxnav.targets import Target
from proxnav.targets.loading import load_target

LOOK = SceneConfig(sensor=SPEED_CLASS, sequence="basilisk")


class RenderedCamera(sysModel.SysModel):
    """Draws what the camera sees at each of its instants and writes it as PNG.

    The axes of the target's body are those of its CAD file, and N is J2000 (ECI). Without `sunStateInMsg` the Sun
    stands where `epoch_utc` puts it. `renderRate` of the CameraConfigMsg [ns] thins the frames; `isOn` 0 makes them
    invalid.
    """

    def __init__(
        self, target: str | Target = "space-rider", *, epoch_utc: str, look: SceneConfig = LOOK, seed: int = 0
    ) -> None:
        super().__init__()
        self.ModelTag = "RenderedCamera"
        self.chaserStateInMsg = messaging.SCStatesMsgReader()
        self.targetStateInMsg = messaging.SCStatesMsgReader()
        self.sunStateInMsg = messaging.SpicePlanetStateMsgReader()
        self.cameraConfigInMsg = messaging.CameraConfigMsgReader()
        self.imageOutMsg = messaging.CameraImageMsg()
        self.image: Image | None = None
        """The last image, grey."""
        self.frames = 0
        self.seconds = 0.0
        """Time spent on drawing and encoding."""
        shape = target if isinstance(target, Target) else load_target(target)
        self._name, self._renderer = shape.name, RaycastRenderer(shape, RaycastConfig())
        self._epoch, self._look, self._seed = parse_iso(epoch_utc), look, seed
        self._next, self._kept = 0, KeptImage(b"")

    def Reset(self, nanos: int) -> None:
        """Checks the wiring."""
        linked(self, "chaserStateInMsg", "targetStateInMsg", "cameraConfigInMsg")
        self._next = nanos

    def UpdateState(self, nanos: int) -> None:
        """Draws one frame where one is due."""
        config = self.cameraConfigInMsg()
        if not config.isOn:
            self.imageOutMsg.write(messaging.CameraImageMsgPayload(), nanos, self.moduleID)
            return
        if nanos < self._next:
            return
        self._next = nanos + int(config.renderRate)
        began = time.perf_counter()
        self.image = self._drawn(nanos, config)
        self._kept = KeptImage(encode_png(self.image))
        payload = self._kept.payload(nanos, int(config.cameraID), self.image.ndim)
        self.imageOutMsg.write(payload, nanos, self.moduleID)
        self.frames += 1
        self.seconds += time.perf_counter() - began

    def _drawn(self, nanos: int, config: Any) -> Image:
        target = craft_state(self.targetStateInMsg())
        scene = scene_from_states(
            target, camera_state(self.chaserStateInMsg(), mounting_of(config)), camera_of(config),
            self._epoch.plus(nanos * NANO).iso(), target_name=self._name, sun_eci=self._sun(target.r_eci_m),
            config=self._look, index=self.frames, seed=self._seed,
        )  # fmt: skip
        return expose(self._renderer.render(scene), scene).image

    def _sun(self, r_eci_target_m: Vector3) -> Vector3 | None:
        """Direction to the Sun; None leaves it to the epoch."""
        if not self.sunStateInMsg.isLinked():
            return None
        return unit(np.array(self.sunStateInMsg().PositionVector) - r_eci_target_m)
