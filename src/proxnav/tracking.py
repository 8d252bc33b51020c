"""Following a target through image files without a network: the first pose, frame after frame, pictures."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from proxnav.datasets.formats.speed_poses import PoseRecord, read_poses
from proxnav.datasets.set.dataset import Dataset
from proxnav.detection.sessions import Backend
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.geometry import Camera, Pose
from proxnav.geometry.types import Image
from proxnav.images.codecs import encode_png, read_image
from proxnav.images.tones import rgb_8_bit
from proxnav.models.loading import load_card
from proxnav.pose.track import Motion, Start, Tracker
from proxnav.records import PoseResult
from proxnav.storage.files import write_atomic
from proxnav.targets import Target
from proxnav.targets.loading import load_target
from proxnav.viewing.outline_overlay import outline_overlay
from proxnav.viewing.overlay import Canvas, caption

GIVEN_UP = 3
"""Frames without a pose after which a model is asked where the target is."""


@dataclass(frozen=True, slots=True)
class TimedImage:
    """An image file and when it was taken."""

    path: Path
    t: float
    """Instant [s]."""


class Follower:
    """`follower(image, camera, t)`: the tracker of one target, which a model starts and, after a loss, starts again.

    One of the first pose and the model may be missing.
    """

    def __init__(
        self, target: Target, first: Pose | None, estimator: PoseEstimator | None, start: Start | None = None
    ) -> None:
        if first is None and estimator is None:
            raise InputError("a track begins with a pose: give the first one, or a model that finds it")
        self.target, self._first, self._estimator = target, first, estimator
        self._start = start or Start()
        self.tracker: Tracker | None = None

    def __call__(self, image: Image, camera: Camera, t: float) -> PoseResult:
        """The pose in an image taken at `t` [s], or the reason why there is none."""
        if self.tracker is None and self._first is not None:
            self.tracker = Tracker.from_pose(self.target, self._first, t, self._start)
        elif self._estimator is not None and (self.tracker is None or self.tracker.misses >= GIVEN_UP):
            return self._found(self._estimator(image, camera), t)
        assert self.tracker is not None
        return self.tracker(image, camera, t)

    def _found(self, result: PoseResult, t: float) -> PoseResult:
        """A pose of the model, from which the track goes on."""
        if result.T_cam_target is not None and result.covariance is not None:
            self.tracker = Tracker(self.target, Motion.begun(t, result.T_cam_target, result.covariance))
        return result


@dataclass(frozen=True, kw_only=True)
class TrackStart:
    """What a track begins with, as people give it."""

    target: str | None = None
    """Name or file of the target, any mesh or target.json; the model's when not given."""
    start: Path | None = None
    """poses.json with the pose of the first image, or of a later one from which to begin."""
    first_pose: tuple[float, float, float, float, float, float, float] | None = None
    """The first pose as numbers: q_cam_target w x y z, then the position x y z in the camera frame [m]."""
    start_sigma_deg: float = 5.0
    """How far the first attitude is known, one standard deviation; 12 searches widely."""
    model: str | None = None
    """Model that finds the first pose where none is given, and the target again after a loss."""
    backend: Backend = "auto"
    """What runs the model's network."""

    def follower(self, first: Pose | None) -> Follower:
        """Follows the target from `first`, or from where the model finds it. InputError where neither is given."""
        known = None if self.model is None else load_card(self.model).target
        name = self.target or known
        if name is None:
            raise InputError("track needs a mesh: give --target NAME or FILE, or a --model, which knows its own")
        target = load_target(name)
        if known is not None and load_target(known).name != target.name:
            raise InputError(f"--model {self.model} knows {known}, --target is {target.name}; leave one of them out")
        if not 0.0 < self.start_sigma_deg <= 30.0:
            raise InputError(f"--start-sigma-deg must be above 0 and at most 30, found {self.start_sigma_deg:g}")
        estimator = None if self.model is None else PoseEstimator.load(self.model, self.backend)
        return Follower(target, first, estimator, Start(float(np.deg2rad(self.start_sigma_deg))))

    def given(self) -> Pose | None:
        """The pose given as numbers. InputError where a file is given as well."""
        if self.first_pose is None:
            return None
        if self.start is not None:
            raise InputError("--start and --first-pose both say where the track begins; give one of them")
        q = np.array(self.first_pose[:4])
        if not abs(np.linalg.norm(q) - 1.0) < 1e-3:
            raise InputError(f"--first-pose begins with a unit quaternion w x y z, found norm {np.linalg.norm(q):.6g}")
        return Pose.from_wxyz("cam", "target", q / np.linalg.norm(q), self.first_pose[4:])


def begun(how: TrackStart, images: list[TimedImage]) -> tuple[Follower, list[TimedImage]]:
    """The follower, and the images from the one on whose pose is known."""
    first = how.given()
    if how.start is not None:
        first, images = first_pose(how.start, images)
    return how.follower(first), images


def track_images(
    images: Sequence[TimedImage], camera: Camera, follow: Follower, overlays: Path | None = None,
    done: Callable[[], None] = lambda: None,
) -> list[PoseRecord]:  # fmt: skip
    """One record per image, in order; `bad_image` where it cannot be read. Pictures go into `overlays`."""
    found: list[PoseRecord] = []
    for one in images:
        image, record = _tracked(one, camera, follow)
        found.append(record)
        if overlays is not None and image is not None:
            write_atomic(overlays / f"{one.path.stem}.png", encode_png(_picture(image, camera, follow.target, record)))
        done()
    return found


def _tracked(one: TimedImage, camera: Camera, follow: Follower) -> tuple[Image | None, PoseRecord]:
    try:
        image = read_image(one.path)
    except InputError:
        return None, PoseRecord(one.path.name, None, "bad_image")
    try:
        result = follow(image, camera, one.t)
    except InputError as error:
        raise InputError(f"{one.path}: {error}") from None
    return image, PoseRecord(one.path.name, result.T_cam_target, result.status, result.covariance, result.trust)


def _picture(image: Image, camera: Camera, target: Target, record: PoseRecord) -> Canvas:
    T = record.T_cam_target
    canvas = rgb_8_bit(image) if T is None else outline_overlay(image, camera, target, T)
    where = "" if T is None else f", {np.linalg.norm(T.t_m):.1f} m"
    return caption(canvas, [f"{record.filename}: {record.status}{where}"])


def timed_images(source: Path, images: Sequence[Path], rate_hz: float, every: int = 1) -> list[TimedImage]:
    """Every `every`-th image with its time: as the scenes of a rendered set say, else `rate_hz` images a second.

    InputError where the images of a set are no sequence in time.
    """
    if not rate_hz > 0.0 or every < 1:
        raise InputError(f"--rate-hz must be positive and --every at least 1, found {rate_hz:g} and {every}")
    times = np.arange(len(images)) / rate_hz
    if (source / "scenes.jsonl").is_file() and (source / "annotations.json").is_file():
        times = np.array([scene.t for scene in Dataset(source).scenes()])
    if len(times) != len(images) or (np.diff(times) <= 0.0).any():
        raise InputError(
            f"{source}: its frames are no sequence in time, there is nothing to follow from one to the next; "
            "use proxnav estimate, or render along a trajectory"
        )
    return [TimedImage(path, float(t)) for path, t in zip(images, times, strict=True)][::every]


def first_pose(path: Path, images: Sequence[TimedImage]) -> tuple[Pose, list[TimedImage]]:
    """The first pose that a poses.json has for one of the images, and the images from that one on.

    A file with a single pose may name any image: it is that of the first.
    """
    poses = {name: one.T_cam_target for name, one in read_poses(path).items() if one.T_cam_target is not None}
    for k, image in enumerate(images):
        pose = poses.get(image.path.name)
        if pose is not None:
            return pose, list(images[k:])
    if len(poses) == 1:
        return next(iter(poses.values())), list(images)
    raise InputError(
        f"{path}: none of its {len(poses)} poses is of one of the images, {images[0].path.name} for one; "
        "name an image in 'filename', or give one pose alone"
    )
