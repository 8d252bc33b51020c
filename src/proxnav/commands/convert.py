"""`proxnav convert`: data sets, poses and trajectories between formats."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

import tyro

from proxnav.trajectories.readers.config import ReaderConfig


@dataclass(frozen=True)
class ConvertConfig:
    """Converts a data set, a file of poses, or a trajectory, into a folder of its own. Nothing is lost that the other
    format can hold; what it cannot hold is said."""

    source: Annotated[tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="SOURCE")]
    """A folder or file of poses, or the files of one trajectory (target first, then chaser)."""
    to: str
    """proxnav, coco, detectron2, yolo-pose, speed, speed+, poses, urso, krn, spnv2, spec2019, spec2021, spark, bop,
    bop-results, tum, shards; trajectories: stk, ccsds, csv."""
    out: Path
    """Folder to write; it must be empty or absent."""
    from_: Annotated[str, tyro.conf.arg(name="from")] = "auto"
    """Format of the source, where its content does not tell."""
    camera: Path | None = None
    """Calibration file, for sources that hold no camera."""
    target: str | None = None
    """Name or file of the target, or a .mat, .json or .csv of its points [m], for sources without 3-D points."""
    quaternion_order: Literal["wxyz", "xyzw"] | None = None
    """Order in the source, where it departs from its format."""
    pixel_origin: Literal["corner", "centre"] | None = None
    """Where pixel (0, 0) lies, for COCO sources that do not say."""
    object_id: int | None = None
    """Which object, where images show several."""
    images: Literal["link", "copy", "none"] = "link"
    """Hard links take no space; `none` writes labels alone."""
    bop_images: Literal["auto", "rgb", "gray"] = "auto"
    """BOP: folder of the images; most of its loaders want rgb, `auto` takes gray for images of one channel."""
    split: str = ""
    """Part of the set for images that are in none, such as lightbox or train."""
    validation_share: float = 0.2
    """Part of an undivided set that becomes validation."""
    frames_per_shard: int = 1000
    """For --to shards."""
    skip_without_pose: bool = False
    """Leave images without a pose out."""
    reader: ReaderConfig = field(default_factory=ReaderConfig)
    """What trajectory files leave open."""


def run(config: ConvertConfig) -> None:
    """Converts, and says what was written and what the format could not hold."""
    from proxnav.datasets import conversion
    from proxnav.datasets.formats import ReadOptions, WriteOptions
    from proxnav.datasets.shards import is_sharded
    from proxnav.errors import InputError, did_you_mean
    from proxnav.geometry import Camera
    from proxnav.targets.named_points import target_or_points
    from proxnav.trajectories.conversion import FORMATS, convert_trajectory, is_trajectory

    if config.to not in (*FORMATS, *conversion.FORMATS):
        known = (*conversion.FORMATS, *FORMATS)
        raise InputError(f"--to {config.to}: expected one of {', '.join(known)}{did_you_mean(config.to, known)}")
    if not config.source:
        raise InputError("no SOURCE; give a data set, a file of poses, or the files of a trajectory")
    source = config.source[0]
    if config.to == "shards" or is_sharded(source):
        print(conversion.convert_shards(source, config.to, config.out, config.frames_per_shard))
    elif config.to in FORMATS:
        print(convert_trajectory(config.source, config.to, config.out, config.reader))
    elif is_trajectory(config.source):
        raise InputError(f"{source}: trajectories are written --to {', '.join(FORMATS)}, not {config.to}")
    else:
        camera = None if config.camera is None else Camera.read(config.camera)
        mesh, points, names = (None, None, ()) if config.target is None else target_or_points(config.target)
        read = ReadOptions(camera, points, names, config.quaternion_order, config.pixel_origin, config.object_id)
        write = WriteOptions(config.images, config.split, config.validation_share, config.bop_images, mesh)
        skip = config.skip_without_pose
        print(conversion.convert_labels(source, config.from_, config.to, config.out, read, write, skip))
