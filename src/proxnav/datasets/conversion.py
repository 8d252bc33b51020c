"""Data sets and files of poses from one format to another, and what the other cannot hold."""

from dataclasses import replace
from pathlib import Path

from proxnav.datasets.formats import READERS, WRITERS, Labels, ReadOptions, WriteOptions, read_labels, write_labels
from proxnav.datasets.set.dataset import Dataset
from proxnav.datasets.shards import unpack_shards, write_shards
from proxnav.errors import InputError, did_you_mean

FORMATS = (*WRITERS, "shards")
_WITHOUT_IMAGES = ("poses", "spec2019", "spec2021", "bop-results")


def convert_labels(
    source: Path, format: str, to: str, out: Path, read: ReadOptions, write: WriteOptions, skip_without_pose: bool
) -> str:
    """Writes the labels of `source` into `out`; what was written and what the format could not hold, a line each."""
    if format not in ("auto", *READERS):
        raise InputError(f"--from {format}: one of {', '.join(READERS)}{did_you_mean(format, READERS)}")
    if not 0.0 <= write.validation_share < 1.0:
        raise InputError(f"--validation-share {write.validation_share}: expected a part of the set, 0 to below 1")
    labels = read_labels(source, format, read)
    found = len(labels)
    if skip_without_pose:
        labels = replace(labels, records=tuple(r for r in labels.records if r.T_cam_target is not None))
    write_labels(labels, out, to, write)
    skipped = f", {found - len(labels)} without a pose left out" if found > len(labels) else ""
    first = f"{len(labels)} images from {labels.format} to {to} in {out}{skipped}"
    return "\n".join([first, *(f"note: {note}" for note in _notes(labels, to))])


def convert_shards(source: Path, to: str, out: Path, frames_per_shard: int) -> str:
    """A data set to shards, or shards to a data set; what was written, in a sentence."""
    if out.exists() and any(out.iterdir()):
        raise InputError(f"{out}: is not empty; give another --out")
    if to == "shards":
        index = write_shards(Dataset(source), out, frames_per_shard)
        return f"{len(index)} frames in {len(index.shards)} shards in {out}"
    if to == "proxnav":
        return f"{len(unpack_shards(source, out))} frames in {out}"
    raise InputError(f"{source}: shards become a data set first: --to proxnav, and that --to {to}")


def _notes(labels: Labels, to: str) -> list[str]:
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
