"""`proxnav convert`: data sets, poses and trajectories between formats."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Literal

import tyro

from proxnav.commands.flight_csv import Craft, flight_csv
from proxnav.datasets.formats import READERS, WRITERS, Labels, ReadOptions, WriteOptions, read_labels, write_labels
from proxnav.datasets.set.dataset import Dataset
from proxnav.datasets.shards import is_sharded, unpack_shards, write_shards
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.records import Trajectory
from proxnav.targets import Target
from proxnav.trajectories.readers.config import ReaderConfig

_FLIGHTS = ("stk", "ccsds", "csv")
_FLIGHT_FILES = {".e", ".a", ".oem", ".aem"}
_WITHOUT_IMAGES = ("poses", "spec2019", "spec2021", "bop-results")


@dataclass(frozen=True)
class ConvertConfig:
    """Converts a data set, a file of poses, or a trajectory, into a folder of its own. Nothing is lost that the other
    format can hold; what it cannot hold is said."""

    source: Annotated[tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="SOURCE")]
    """A folder or file of poses, or the files of one trajectory (target first, then chaser)."""
    to: str
    """proxnav, coco, detectron2, speed, speed+, poses, urso, krn, spnv2, spec2019, spec2021, spark, bop, bop-results,
    shards; trajectories: stk, ccsds, csv."""
    out: Path
    """Folder to write; it must be empty or absent."""
    from_: Annotated[str, tyro.conf.arg(name="from")] = "auto"
    """Format of the source, where its content does not tell."""
    camera: Path | None = None
    """camera.json with the keys of SPEED+, for sources that hold no camera."""
    target: str | None = None
    """Name or file of the target, or a .mat, .json or .csv of its points [m], for sources without 3-D points."""
    quaternion_order: Literal["wxyz", "xyzw"] | None = None
    """Order in the source, where it departs from its format."""
    pixel_origin: Literal["corner", "centre"] | None = None
    """Of COCO sources that do not say where pixel (0, 0) lies."""
    object_id: int | None = None
    """Which object, where images show several."""
    images: Literal["link", "copy", "none"] = "link"
    """Hard links take no space; `none` writes labels alone."""
    split: str = ""
    """Part of the set for images that are in none, such as lightbox or train."""
    validation_share: float = 0.2
    """Part of an undivided set that becomes validation."""
    frames_per_shard: int = 1000
    """For --to shards."""
    skip_without_pose: bool = False
    """Leave images without a pose out."""
    flight: ReaderConfig = field(default_factory=ReaderConfig)
    """What trajectory files leave open."""


def run(config: ConvertConfig) -> None:
    """Reads, converts, writes, and says what was written and what the format could not hold."""
    if config.to not in (*_FLIGHTS, *WRITERS, "shards"):
        raise InputError(f"--to {config.to}: one of {', '.join((*WRITERS, 'shards', *_FLIGHTS))}")
    if not config.source:
        raise InputError("no SOURCE; give a data set, a file of poses, or the files of a trajectory")
    if config.to == "shards" or is_sharded(config.source[0]):
        convert_shards(config)
    elif config.to in _FLIGHTS:
        convert_flight(config)
    else:
        convert_labels(config)


def convert_shards(config: ConvertConfig) -> None:
    """A data set to shards, or shards to a data set."""
    if config.out.exists() and any(config.out.iterdir()):
        raise InputError(f"{config.out}: is not empty; give another --out")
    if config.to == "shards":
        index = write_shards(Dataset(config.source[0]), config.out, config.frames_per_shard)
        print(f"{len(index)} frames in {len(index.shards)} shards in {config.out}")
    elif config.to == "proxnav":
        print(f"{len(unpack_shards(config.source[0], config.out))} frames in {config.out}")
    else:
        raise InputError(f"{config.source[0]}: shards become a data set first: --to proxnav, and that --to {config.to}")


def convert_labels(config: ConvertConfig) -> None:
    """A data set or a file of poses."""
    source = _checked_source(config)
    target, read = _options(config)
    labels = read_labels(source, config.from_, read)
    found = len(labels)
    if config.skip_without_pose:
        labels = replace(labels, records=tuple(r for r in labels.records if r.T_cam_target is not None))
    write = WriteOptions(config.images, config.split, config.validation_share, target)
    write_labels(labels, config.out, config.to, write)
    skipped = f", {found - len(labels)} without a pose left out" if found > len(labels) else ""
    print(f"{len(labels)} images from {labels.format} to {config.to} in {config.out}{skipped}")
    for note in notes(labels, config.to):
        print(f"note: {note}")


def notes(labels: Labels, to: str) -> list[str]:
    """What the format could not hold."""
    said = []
    missing = sum(record.image is None for record in labels.records)
    if missing and to not in _WITHOUT_IMAGES:
        said.append(f"{missing} of {len(labels)} images are not beside the labels; their labels alone were written")
    if to == "bop" and labels.camera is not None and labels.camera.is_distorted:
        said.append("BOP knows no lens distortion; scene_camera.json has it as 'distortion', which others ignore")
    if to != "poses" and any(record.covariance is not None for record in labels.records):
        said.append(f"{to} has no covariances; --to poses keeps them")
    return said


def convert_flight(config: ConvertConfig) -> None:
    """A trajectory: what the files hold of target and chaser, orbit and attitude; nothing that they do not hold."""
    from proxnav.trajectories import read_trajectory

    orbits, attitudes = _held(config)
    reader = config.flight
    if len(attitudes) > 1 and reader.q_chaser_cam is None:
        reader = replace(reader, q_chaser_cam=(1.0, 0.0, 0.0, 0.0))  # the chaser's own attitude, not a pointing one
    flight = read_trajectory(config.source, reader)
    contents = _flight_files(flight, config.to, orbits, attitudes)
    taken = [name for name in contents if (config.out / name).exists()]
    if taken:
        raise InputError(f"{config.out / taken[0]}: exists; give another --out")
    config.out.mkdir(parents=True, exist_ok=True)
    for name, text in contents.items():
        (config.out / name).write_text(text, encoding="utf-8")
    print(f"{len(flight)} instants from {flight.epoch_utc} in {config.out}: {', '.join(contents)}")


def _held(config: ConvertConfig) -> tuple[list[Craft], list[Craft]]:
    """Whose orbits and whose attitudes the files hold; a relative orbit is the chaser's about an assumed target's."""
    from proxnav.trajectories.read import read_histories
    from proxnav.trajectories.readers.history import OrbitHistory

    found = [history for path in config.source for history in read_histories(path, config.flight)]
    orbits = [history for history in found if isinstance(history, OrbitHistory)]
    relative = any(history.frame.kind == "ric" for history in orbits)
    both: list[Craft] = ["target", "chaser"]
    return both if relative else both[: len(orbits)], both[: len(found) - len(orbits)]


def _flight_files(flight: Trajectory, to: str, orbits: list[Craft], attitudes: list[Craft]) -> dict[str, str]:
    """File name to content."""
    from proxnav.trajectories import write

    if to == "csv":
        return {"trajectory.csv": flight_csv(flight, orbits, attitudes)}
    if to == "stk":
        found = {f"{craft}.e": write.stk_ephemeris(flight, craft) for craft in orbits}
        return found | {f"{craft}.a": write.stk_attitude(flight, craft) for craft in attitudes}
    found = {f"{craft}.oem": write.oem(flight, craft) for craft in orbits}
    return found | {f"{craft}.aem": write.aem(flight, craft) for craft in attitudes}


def _checked_source(config: ConvertConfig) -> Path:
    source, *more = config.source
    if source.suffix.lower() in _FLIGHT_FILES or more:
        raise InputError(f"{source}: trajectories are written --to {', '.join(_FLIGHTS)}, not {config.to}")
    if config.from_ not in ("auto", *READERS):
        raise InputError(f"--from {config.from_}: one of {', '.join(READERS)}")
    if not 0.0 <= config.validation_share < 1.0:
        raise InputError(f"--validation-share {config.validation_share}: expected a part of the set, 0 to below 1")
    return source


def _options(config: ConvertConfig) -> tuple[Target | None, ReadOptions]:
    """(the target's mesh where one was named, what the user said about the source)."""
    camera = None if config.camera is None else Camera.from_speed_json(config.camera)
    target, points, names = _target(config.target)
    order, origin = config.quaternion_order, config.pixel_origin
    return target, ReadOptions(camera, points, names, order, origin, config.object_id)


def _target(name: str | None) -> tuple:
    from proxnav.targets.keypoints.point_files import load_points
    from proxnav.targets.loading import load_target

    if name is None:
        return None, None, ()
    path = Path(name)
    if path.suffix.lower() in (".mat", ".csv", ".json") and not path.with_name("mesh.npz").is_file():
        return None, *load_points(path)
    target = load_target(name)
    return target, target.keypoints_m, target.keypoint_names
