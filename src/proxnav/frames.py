"""One scene to one labelled frame: the job that every worker runs, whatever renders and wherever it runs."""

from collections.abc import Callable
from dataclasses import dataclass

from proxnav.datasets.set.labelling import label_frame
from proxnav.geometry.types import Image, Mask
from proxnav.records import FrameLabel, RenderedFrame, SceneSpec
from proxnav.rendering.config import FrameConfig
from proxnav.rendering.cycles.config import CyclesConfig
from proxnav.rendering.cycles.renderer import CyclesRenderer
from proxnav.rendering.raycast import RaycastConfig, RaycastRenderer
from proxnav.sensor.expose import expose
from proxnav.targets import Target
from proxnav.targets.keypoints.visibility import visible_keypoints
from proxnav.targets.loading import load_target


@dataclass(frozen=True, slots=True, eq=False)
class LabelledFrame:
    """What the sensor read and what is true about it."""

    image: Image
    mask: Mask
    label: FrameLabel


@dataclass(frozen=True)
class FrameJob:
    """Builds, once per process, the function that turns scenes of one target into frames. Can be pickled."""

    target: str | Target
    """By name or file; as a value where the worker may not have the file."""
    config: FrameConfig

    def __call__(self) -> Callable[[SceneSpec], LabelledFrame]:
        target = self.target if isinstance(self.target, Target) else load_target(self.target)
        render = _renderer(target, self.config)

        def make(scene: SceneSpec) -> LabelledFrame:
            frame = render(scene)
            label = label_frame(scene, target, frame.mask, visible_keypoints(target, scene.T_cam_target))
            return LabelledFrame(expose(frame, scene).image, frame.mask, label)

        return make


def _renderer(target: Target, config: FrameConfig) -> Callable[[SceneSpec], RenderedFrame]:
    if config.renderer == "raycast":
        return RaycastRenderer(target, RaycastConfig()).render
    return CyclesRenderer(target, CyclesConfig(samples=config.samples, threads=config.threads)).render
