"""Estimating many images, or scenes that are ray-cast for it, over processes or machines: one frame a job."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from proxnav.cluster.carried import Carried
from proxnav.cluster.jobs import POOL, is_elsewhere, run_anywhere
from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.detection.sessions import Backend
from proxnav.errors import InputError, InputNote
from proxnav.estimator import PoseEstimator
from proxnav.frames import FrameConfig, FrameJob
from proxnav.geometry import Camera
from proxnav.images.codecs import decode_image, read_image_file
from proxnav.models.loading import carried_model, load_card
from proxnav.pose.trust import CheckedBy
from proxnav.records import Keypoints, PoseResult, SceneSpec, Sky
from proxnav.targets import Target

Sent = tuple[str, bytes]
"""Name and content of an image, for workers that do not see the file."""


@dataclass(frozen=True)
class EstimateJob:
    """Builds, once per process, the function from an image to its pose and keypoints. Can be pickled."""

    model: str | Carried
    camera: Camera
    backend: Backend = "auto"
    threads: int = 1
    """Threads of the network; with one, sums come in the same order everywhere."""
    skies: Mapping[str, Sky] = field(default_factory=dict)
    """Sun and Earth by the name of the image; the view of images that are not named is not predicted."""
    checked_by: CheckedBy = "everything"

    def __call__(self) -> Callable[[Path | Sent], tuple[PoseRecord, Keypoints]]:
        estimator = replace(PoseEstimator.load(self.model, self.backend, self.threads), checked_by=self.checked_by)
        return lambda item: estimate_image(estimator, item, self.camera, self.skies)


@dataclass(frozen=True)
class SceneEstimateJob:
    """Builds, once per process, the function that ray-casts a scene and estimates in its frame. Can be pickled."""

    model: str | Carried
    target: Target
    backend: Backend = "auto"
    threads: int = 1
    """Threads of the network; 0 takes all cores, which is for a job that is alone on its machine."""

    def __call__(self) -> Callable[[SceneSpec], tuple[Keypoints, PoseResult]]:
        estimator = PoseEstimator.load(self.model, self.backend, self.threads)
        draw = FrameJob(self.target, FrameConfig("raycast"))()
        return lambda scene: estimator.keypoints_and_pose(draw(scene).image, scene.camera)


def estimate_image(
    estimator: PoseEstimator, item: Path | Sent, camera: Camera, skies: Mapping[str, Sky]
) -> tuple[PoseRecord, Keypoints]:
    """Pose and keypoints of one image; `bad_image` where it cannot be read. A refusal names the image."""
    where = item[0] if isinstance(item, tuple) else str(item)
    name = Path(where).name
    try:
        image = decode_image(item[1] if isinstance(item, tuple) else read_image_file(item), where)
    except InputError:
        return PoseRecord(name, None, "bad_image"), Keypoints.none("bad_image", len(estimator.points_target_m))
    try:
        keypoints, result = estimator.keypoints_and_pose(image, camera, sky=skies.get(name))
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    return PoseRecord(name, result.T_cam_target, result.status, result.covariance, result.trust), keypoints


def estimate_images(
    images: Sequence[Path], camera: Camera, model: str, backend: Backend = "auto", threads: int = 0, workers: int = 1,
    on: str = POOL, done: Callable[[], None] = lambda: None, skies: Mapping[str, Sky] | None = None,
    checked_by: CheckedBy = "everything",
) -> tuple[list[PoseRecord], list[Keypoints]]:  # fmt: skip
    """One record and its keypoints per image, in order; `threads` are those of a single process, workers have one.

    Poses of images that `skies` names are checked by the view that they predict, all of them by the other evidence.
    """
    threads = threads if workers == 1 and on == POOL else 1
    job = EstimateJob(carried_model(model, on), camera, backend, threads, skies or {}, checked_by)
    send = _content if is_elsewhere(on) else None
    found: dict[Path, tuple[PoseRecord, Keypoints]] = {}
    for path, answer in run_anywhere(job, images, workers, on, lambda path: path.name, send):
        found[path] = answer
        done()
    return [found[path][0] for path in images], [found[path][1] for path in images]


def note_other_target(model: str, shown: str) -> None:
    """Says, as an `InputNote`, that a data set shows another target than the model knows."""
    known = load_card(model).target
    if known != shown:
        warnings.warn(f"the set shows {shown}, the model knows {known}; give its --model", InputNote, stacklevel=2)


def _content(path: Path) -> Sent:
    try:
        return path.name, read_image_file(path)
    except InputError:
        return path.name, b""  # no image: the worker says so
