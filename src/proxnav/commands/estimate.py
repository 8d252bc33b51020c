"""`proxnav estimate`: images or a data set to poses.json."""

import warnings
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from proxnav.cli.options import CameraOptions, ModelOptions, WorkerOptions
from proxnav.pose.trust import CheckedBy


@dataclass(frozen=True)
class EstimateConfig(ModelOptions, CameraOptions, WorkerOptions):
    """Estimates the pose of the target in every image and writes poses.json (SPEED+ keys, status, covariance)."""

    input: Annotated[Path, tyro.conf.Positional]
    """A data set, a folder of images, or one image."""
    out: Path = Path("poses.json")
    """File to write, .json or .csv."""
    run: Path | None = None
    """Folder for a run that needs no truth, with overlays: proxnav report and proxnav view show it."""
    threads: int = 0
    """Threads of the network; 0 takes all cores."""
    sky: Path | None = None
    """Sun and Earth in camera axes, a csv (docs/pose.md) or a data set whose scenes say it; poses are checked by it."""
    checked_by: CheckedBy = "everything"
    """`nothing` leaves poses as the alignment gives them: no verdict, no protection levels, nothing refused by them."""


def run(config: EstimateConfig) -> None:
    """Finds the images, estimates, writes."""
    from proxnav.cli.progress import progress, say_when_compiling
    from proxnav.datasets.formats.pose_tables import check_pose_file, write_pose_file
    from proxnav.datasets.image_folders import camera_beside, find_images, fitting_images
    from proxnav.datasets.set.dataset import Dataset
    from proxnav.datasets.skies import read_skies
    from proxnav.errors import InputError, InputNote
    from proxnav.estimation import estimate_images, note_other_target
    from proxnav.models.loading import load_card
    from proxnav.records.estimates import REASONS
    from proxnav.viewing.found_run import Found, check_found_run, write_found_run

    check_pose_file(config.out)
    if config.run is not None:
        check_found_run(config.run)
    images, skies = find_images(config.input), {} if config.sky is None else read_skies(config.sky)
    if config.sky is not None and not any(path.name in skies for path in images):
        raise InputError(f"--sky {config.sky}: names none of the {len(images)} images; give their file names")
    if (config.input / "target.json").is_file():
        note_other_target(config.model, Dataset(config.input).target_name)
    camera = config.camera_or(lambda: camera_beside(config.input))
    chosen = fitting_images(images, camera)
    if chosen.other:
        warnings.warn(chosen.note(), InputNote, stacklevel=2)
    images = list(chosen.fitting)
    say_when_compiling("pose")
    with progress("estimate", len(images)) as done:
        records, keypoints = estimate_images(
            images, camera, config.model, config.backend, config.threads, config.workers, config.on, done, skies,
            config.checked_by,
        )  # fmt: skip
    if all(record.status == "bad_image" for record in records):
        raise InputError(f"{config.input}: none of {len(records)} images can be decoded, they are damaged")
    write_pose_file(config.out, records)
    if config.run is not None:
        card = load_card(config.model)
        write_found_run(config.run, Found(images, camera, records, keypoints, card.keypoints_m, card.target), config)
    poses = sum(record.T_cam_target is not None for record in records)
    print(f"{poses} poses from {len(records)} images in {config.out}")
    refused = Counter(record.status for record in records if record.T_cam_target is None and record.trust is not None)
    for status, count in refused.most_common():
        print(f"  {count} {status}: {REASONS[status]}")
