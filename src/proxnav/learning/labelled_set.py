"""Training samples of a data set on disk: a folder, or shards that may lie in object storage."""

from collections.abc import Callable
from pathlib import Path

from proxnav.datasets.set.dataset import Dataset
from proxnav.datasets.shards import is_sharded, read_index
from proxnav.detection.samples import SampleSource, TrainingSample, shuffled
from proxnav.detection.shard_stream import streamed
from proxnav.errors import InputError
from proxnav.images.tones import grey_8_bit
from proxnav.targets.loading import load_target


def set_of_target(place: Path, target: str) -> Dataset:
    """A data set whose keypoints are those of the target; InputError where it labels others."""
    dataset = Dataset(place)
    _check_names(dataset.keypoint_names, place, target)
    return dataset


def learnt_images(dataset: Dataset, kept_aside: int) -> int:
    """How many images of the set are learnt from: those that are not kept aside for validation."""
    left = len(dataset) - kept_aside
    if left < 1:
        raise InputError(f"--validation {kept_aside} leaves none of the {len(dataset)} images of {dataset.folder}")
    return left


def source_of(place: Path, target: str, kept_aside: int) -> SampleSource:
    """The endless stream of the set's samples; of a folder, all but the last `kept_aside`."""
    if is_sharded(place):
        index = read_index(place)
        _check_names(index.keypoint_names, place, target)
        return streamed(index, seed=0)
    dataset = set_of_target(place, target)
    return shuffled(sample_reader(dataset), learnt_images(dataset, kept_aside), seed=0)


def sample_reader(dataset: Dataset) -> Callable[[int], TrainingSample]:
    """The function from a frame's number to its sample."""

    def read(index: int) -> TrainingSample:
        label = dataset.labels[index]
        return TrainingSample(
            grey_8_bit(dataset.image(index)), label.keypoints_px, label.visibility, label.box_xyxy, dataset.mask(index)
        )

    return read


def _check_names(names: tuple[str, ...], place: Path, target: str) -> None:
    if names != load_target(target).keypoint_names:
        raise InputError(f"{place} labels other keypoints than target {target} has; name the set's --target")
