"""Estimating many images over processes or machines: the same estimator, one image a job."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from proxnav.cli.progress import progress
from proxnav.cluster.carried import Carried
from proxnav.cluster.jobs import is_elsewhere, run_anywhere
from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.detection.sessions import Backend
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator, shipped_models
from proxnav.geometry import Camera
from proxnav.images.codecs import decode_image, read_image_file
from proxnav.records import Keypoints

Sent = tuple[str, bytes]
"""Name and content of an image, for workers that do not see the file."""


@dataclass(frozen=True)
class EstimateJob:
    """Builds, once per process, the function from an image to its pose and keypoints. Can be pickled."""

    model: str | Carried
    camera: Camera
    backend: Backend

    def __call__(self) -> Callable[[Path | Sent], tuple[PoseRecord, Keypoints]]:
        estimator = load_model(self.model, self.backend)

        def estimate(item: Path | Sent) -> tuple[PoseRecord, Keypoints]:
            name = item[0] if isinstance(item, tuple) else item.name
            try:
                image = decode_image(item[1] if isinstance(item, tuple) else read_image_file(item), name)
            except InputError:
                return bad_image(name, estimator)
            return observe(estimator, image, self.camera, name)

        return estimate


def observe(estimator: PoseEstimator, image: np.ndarray, camera: Camera, name: str) -> tuple[PoseRecord, Keypoints]:
    """What the estimator says of one image; its refusal names the image."""
    try:
        keypoints, result = estimator.observe(image, camera)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    return PoseRecord(Path(name).name, result.T_cam_target, result.status, result.covariance), keypoints


def bad_image(name: str, estimator: PoseEstimator) -> tuple[PoseRecord, Keypoints]:
    """Of an image that cannot be read."""
    return PoseRecord(name, None, "bad_image"), Keypoints.none("bad_image", len(estimator.points_target_m))


def carried_model(model: str, on: str) -> str | Carried:
    """What a worker needs to load the model: the name of a shipped one, the files of another where it sees none."""
    return model if not is_elsewhere(on) or model in shipped_models() else Carried.of(Path(model))


def load_model(model: str | Carried, backend: Backend = "auto", threads: int = 1) -> PoseEstimator:
    """With one thread where workers share the cores: sums come in the same order everywhere."""
    if isinstance(model, str):
        return PoseEstimator.load(model, backend, threads)
    with model.unpacked() as folder:
        return PoseEstimator.load(folder, backend, threads)


def estimate_anywhere(
    images: Sequence[Path], camera: Camera, model: str, backend: Backend, workers: int, on: str
) -> tuple[list[PoseRecord], list[Keypoints]]:
    """One record and its keypoints per image, in order."""
    found: dict[Path, tuple[PoseRecord, Keypoints]] = {}
    send = _content if is_elsewhere(on) else None
    with progress("estimate", len(images)) as done:
        job = EstimateJob(carried_model(model, on), camera, backend)
        for path, seen in run_anywhere(job, images, workers, on, lambda path: path.name, send):
            found[path] = seen
            done()
    return [found[path][0] for path in images], [found[path][1] for path in images]


def _content(path: Path) -> Sent:
    try:
        return path.name, read_image_file(path)
    except InputError:
        return path.name, b""  # no image: the worker says so
