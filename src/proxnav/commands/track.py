"""`proxnav track`: a CAD model followed from image to image, without a network."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from proxnav.cli.options import CameraOptions
from proxnav.tracking import TrackStart


@dataclass(frozen=True)
class TrackConfig(TrackStart, CameraOptions):
    """Follows a target through images in the order of time by laying its mesh onto their edges, and writes poses.json.

    It needs the mesh and one pose to begin with (--start, --first-pose or --model), good to a few degrees and 2 % of
    the range; more is often mended where --start-sigma-deg says so. Where the edges contradict the status is `lost`.
    """

    input: Annotated[Path, tyro.conf.Positional]
    """A sequence that proxnav rendered, or a folder of images in the order of their names."""
    out: Path = Path("poses.json")
    """File to write, as `proxnav estimate` writes it."""
    rate_hz: float = 1.0
    """Images a second; a rendered sequence knows its own times."""
    every: int = 1
    """Take every n-th image."""
    overlays: Path | None = None
    """Folder for pictures with the outline drawn over each frame."""


def run(config: TrackConfig) -> None:
    """Follows, writes, counts."""
    from collections import Counter

    from proxnav.cli.progress import progress, say_when_compiling
    from proxnav.datasets.formats.speed_poses import write_poses
    from proxnav.datasets.image_folders import camera_beside, find_images
    from proxnav.storage.files import check_new_file
    from proxnav.tracking import begun, timed_images, track_images

    check_new_file(config.out)
    images = timed_images(config.input, find_images(config.input), config.rate_hz, config.every)
    follow, images = begun(config, images)
    camera = config.camera_or(lambda: camera_beside(config.input))
    say_when_compiling("pose")
    with progress("track", len(images)) as done:
        records = track_images(images, camera, follow, config.overlays, done)
    write_poses(config.out, records)
    counts = Counter(record.status for record in records)
    others = "".join(f", {count} {status}" for status, count in counts.most_common() if status != "ok")
    print(f"{counts['ok']} poses from {len(records)} images in {config.out}{others}")
