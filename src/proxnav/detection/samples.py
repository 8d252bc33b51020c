"""What a detector learns from: one image with its keypoints, and streams of them that can be entered anywhere."""

import logging
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import count

import numpy as np
from jaxtyping import Bool, Float, Num, Shaped

from proxnav.errors import InputError
from proxnav.geometry.arrays import frozen
from proxnav.geometry.types import Box

_log = logging.getLogger(__name__)

MAX_UNREADABLE_SHARE = 0.2
"""Above this share of unreadable samples in a pass the data set is broken, not merely scratched."""


@dataclass(frozen=True, slots=True, eq=False)
class TrainingSample:
    """One labelled image; keypoints follow the target's list, pixels have the corner origin."""

    image: Shaped[np.ndarray, "..."]
    """(h, w) or (h, w, 3) uint8."""
    keypoints_px: Float[np.ndarray, "n_keypoints 2"]
    """Keypoints [px]; NaN where the point has no image."""
    visibility: Num[np.ndarray, "n_keypoints"]
    """0 outside the image, 1 hidden, 2 visible (COCO)."""
    box_xyxy: Box
    """Outer edges of the target [px]; NaN when the image shows none."""
    mask: Bool[np.ndarray, "mask_height mask_width"] | None = None
    """Pixels of the target."""

    def __post_init__(self) -> None:
        _check_image(self.image)
        n = len(self.keypoints_px)
        points = frozen(self.keypoints_px, (n, 2), "keypoints_px")
        visibility = frozen(self.visibility, (n,), "visibility", np.int64)
        unplaced = ~np.isfinite(points).all(axis=1)
        object.__setattr__(self, "keypoints_px", points)
        object.__setattr__(self, "visibility", frozen(np.where(unplaced, 0, visibility), (n,), "visibility", np.int64))
        object.__setattr__(self, "box_xyxy", frozen(self.box_xyxy, (4,), "box_xyxy"))
        if self.mask is not None and self.mask.shape != self.image.shape[:2]:
            raise InputError(f"the mask is {self.mask.shape}, its image {self.image.shape[:2]}: make them the same")

    @property
    def has_target(self) -> bool:
        """Whether the image shows the target at all: a finite box of positive size."""
        box = self.box_xyxy
        return bool(np.isfinite(box).all() and box[2] > box[0] and box[3] > box[1])


SampleSource = Callable[[int, int], Iterator[TrainingSample]]
"""`source(start, stride)` yields samples start, start + stride, ... without end. Sample i is the same whenever it is
asked for: that makes one integer the whole data position of a run, and lets every process take its own share."""


def shuffled(load: Callable[[int], TrainingSample], n_samples: int, seed: int) -> SampleSource:
    """A stream over a finite data set: each pass in its own order; an unreadable sample gives way to the next one.

    >>> blank = TrainingSample(np.zeros((4, 4), np.uint8), np.zeros((1, 2)), np.zeros(1), np.full(4, np.nan))
    >>> source = shuffled(lambda index: blank, n_samples=3, seed=0)
    >>> next(source(1000, 1)).has_target
    False
    """
    if n_samples < 1:
        raise InputError("the data set holds no samples: render some first or check the path")
    unreadable: set[int] = set()

    def read(index: int) -> TrainingSample:
        for candidate in range(index, index + n_samples):
            try:
                return load(candidate % n_samples)
            except InputError as error:
                _count_unreadable(unreadable, candidate % n_samples, n_samples, error)
        raise InputError(f"none of the {n_samples} samples can be read: check the data set's path and format")

    def stream(start: int, stride: int) -> Iterator[TrainingSample]:
        current, order = -1, np.arange(n_samples)
        for position in count(start, stride):
            epoch, place = divmod(position, n_samples)
            if epoch != current:
                current, order = epoch, np.random.default_rng([seed, epoch]).permutation(n_samples)
            yield read(int(order[place]))

    return stream


def _count_unreadable(seen: set[int], index: int, n_samples: int, error: InputError) -> None:
    if index in seen:
        return
    seen.add(index)
    _log.warning("sample %d skipped, %d so far: %s", index, len(seen), error)
    if len(seen) > max(1, MAX_UNREADABLE_SHARE * n_samples):
        raise InputError(f"{len(seen)} of {n_samples} samples cannot be read, the last one because: {error}") from error


def check_keypoint_count(sample: TrainingSample, n_keypoints: int) -> None:
    """Raises InputError where a sample does not have the keypoints that the network was built for."""
    if len(sample.keypoints_px) != n_keypoints:
        raise InputError(
            f"a sample has {len(sample.keypoints_px)} keypoints, the network {n_keypoints}: "
            "use the same target and keypoint subset for data and network"
        )


def _check_image(image: Shaped[np.ndarray, "..."]) -> None:
    grey_or_colour = image.ndim == 2 or (image.ndim == 3 and image.shape[2] == 3)
    if image.dtype != np.uint8 or not grey_or_colour or 0 in image.shape:
        raise InputError(f"a training image must be uint8 (h, w) or (h, w, 3), found {image.dtype} {image.shape}")


def with_keypoints(source: SampleSource, indices: tuple[int, ...]) -> SampleSource:
    """The same stream with some of the keypoints only, in the order of `indices`: a target's subset, for example."""
    chosen = list(indices)

    def stream(start: int, stride: int) -> Iterator[TrainingSample]:
        for sample in source(start, stride):
            if max(chosen) >= len(sample.keypoints_px):
                raise InputError(
                    f"keypoint {max(chosen)} was asked for, samples have {len(sample.keypoints_px)} (counted from 0)"
                )
            yield replace(sample, keypoints_px=sample.keypoints_px[chosen], visibility=sample.visibility[chosen])

    return stream
