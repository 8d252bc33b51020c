"""Ray-casting a scene and estimating in it as one job: what benchmarks do that keep no images."""

from collections.abc import Callable
from dataclasses import dataclass

from proxnav.cluster.carried import Carried
from proxnav.commands.estimate_jobs import load_model
from proxnav.detection.sessions import Backend
from proxnav.frames import FrameConfig, FrameJob
from proxnav.records import Keypoints, PoseResult, SceneSpec
from proxnav.targets import Target


@dataclass(frozen=True)
class LookJob:
    """Builds, once per process, the function from a scene to what the estimator sees in its frame. Can be pickled."""

    model: str | Carried
    target: Target
    backend: Backend = "auto"
    threads: int = 1
    """Of the network; 0 takes all cores, which is for a job that is alone on its machine."""

    def __call__(self) -> Callable[[SceneSpec], tuple[Keypoints, PoseResult]]:
        estimator = load_model(self.model, self.backend, self.threads)
        draw = FrameJob(self.target, FrameConfig("raycast"))()
        return lambda scene: estimator.observe(draw(scene).image, scene.camera)
