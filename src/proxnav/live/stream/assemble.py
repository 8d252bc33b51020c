"""A stream put together from what people give: source, estimator or tracker, filter, files and view."""

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from proxnav.datasets.image_folders import camera_beside
from proxnav.detection.sessions import Backend
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.geometry import Camera
from proxnav.live.stream.arrivals import Source
from proxnav.live.stream.folder import FolderSource, Times
from proxnav.live.stream.fused import Fused
from proxnav.live.stream.loop import Estimate, Frames, Loop, Tell, no_filter
from proxnav.live.stream.told import json_lines, told_to
from proxnav.live.stream.video import CameraSource, VideoSource
from proxnav.navigation.config import NavigationConfig
from proxnav.targets import Target
from proxnav.targets.loading import load_target
from proxnav.tracking import TrackStart

_CAMERA = "camera:"
SHIPPED = "space-rider"


@dataclass(frozen=True, kw_only=True)
class StreamOptions:
    """How a stream is answered."""

    model: str | None = None
    """Model that estimates each image, or starts the track where --target is given; space-rider when neither is."""
    backend: Backend = "auto"
    """What runs the model's network."""
    target: str | None = None
    """Name or file of a mesh that is followed from image to image, as `proxnav track` does."""
    first_pose: tuple[float, float, float, float, float, float, float] | None = None
    """Where that begins without a model: q_cam_target w x y z, then the position x y z in the camera frame [m]."""
    start_sigma_deg: float = 5.0
    """How far the first attitude is known, one standard deviation."""
    frames: Frames = "newest"
    """newest: when images come too fast, old ones are dropped and counted; all: the source waits, for files."""
    waiting: int = 2
    """Images that may wait for an answer."""
    times: Times = "file"
    """When an image of a folder was taken: file, when it was written; name, the last number in its name [s]."""
    idle_s: float = 0.0
    """A folder ends when nothing came for so long; 0 never ends."""
    records: Path | None = None
    """Records of the other sensors, for the filter: a folder as `navigate` reads it."""
    filter: NavigationConfig = field(default_factory=NavigationConfig)


def source_of(where: str, options: StreamOptions) -> Source:
    """A folder, a video file, or camera:NUMBER. InputError where there is none of them."""
    if where.startswith(_CAMERA):
        number = where.removeprefix(_CAMERA)
        if not number.isdigit() or options.frames == "all":
            raise InputError(f"{where}: a camera is camera:NUMBER, and it does not wait (--frames newest)")
        return CameraSource(int(number))
    path = Path(where)
    if path.is_dir():
        return FolderSource(path, options.times, options.idle_s)
    if path.is_file():
        return VideoSource(path, options.frames == "newest")
    raise InputError(f"{where}: no such folder or video file; a camera device is camera:NUMBER")


@contextmanager
def assembled(
    where: str, camera_file: Camera | None, options: StreamOptions, out: Path | None, view_port: int | None
) -> Iterator[tuple[Loop, Source]]:
    """The loop and its source; files and view are closed at the end."""
    if options.waiting < 1:
        raise InputError(f"--waiting must be at least 1, found {options.waiting}")
    source, say = source_of(where, options), _say
    camera = camera_file or camera_beside(Path(where))
    estimate, target = _estimate_of(options)
    fuse = no_filter
    if options.records is not None:
        from_1970 = isinstance(source, CameraSource) or (isinstance(source, FolderSource) and options.times == "file")
        fuse = Fused.of(options.records, target.keypoints_m, camera, options.filter, from_1970)
    with ExitStack() as open_files:
        tells: list[Tell] = (
            [json_lines(sys.stdout)] if out is None else [open_files.enter_context(told_to(out, camera))]
        )
        if view_port is not None:
            tells.append(open_files.enter_context(_watched(camera, target, view_port, say)))
        yield Loop(camera, estimate, tells, say, fuse, options.frames, options.waiting), source


def _estimate_of(options: StreamOptions) -> tuple[Estimate, Target]:
    """The tracker where a mesh or a first pose is given, else the model's estimator; and the target it knows."""
    if options.target is None and options.first_pose is None:
        estimator = PoseEstimator.load(options.model or SHIPPED, options.backend)
        return lambda image, camera, _: estimator(image, camera), load_target(estimator.target)
    how = TrackStart(
        target=options.target, first_pose=options.first_pose, start_sigma_deg=options.start_sigma_deg,
        model=options.model, backend=options.backend,
    )  # fmt: skip
    follow = how.follower(how.given())
    return follow, follow.target


@contextmanager
def _watched(camera: Camera, target: Target, port: int, say: Callable[[str], None]) -> Iterator[Tell]:
    from proxnav.viewing.live_view import LiveView

    view = LiveView(camera, target, port)
    say(f"watch it with: rerun {view.url}")
    try:
        yield lambda answer, image: view.show(
            answer.t, image, f"{answer.name}: {answer.result.status}", answer.result.T_cam_target, answer.state
        )
    finally:
        view.close()


def _say(sentence: str) -> None:
    print(f"proxnav live: {sentence}", file=sys.stderr, flush=True)
