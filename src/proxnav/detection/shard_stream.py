"""Shards as training samples: one shard in memory at a time, the same sample at the same place for every rank."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import count
from typing import TypeVar

import numpy as np
from jaxtyping import Int

from proxnav.datasets.shards import ShardIndex, StoredFrame
from proxnav.detection.samples import SampleSource, TrainingSample
from proxnav.images.codecs import decode_image
from proxnav.images.tones import grey_8_bit

Frame = TypeVar("Frame")


def streamed(index: ShardIndex, seed: int) -> SampleSource:
    """The endless stream of a sharded set: each pass has its own order of shards, and of frames within a shard.

    A rank reads every shard and decodes its own frames of it alone. Entering the stream anywhere reads one shard.
    """
    counts = [frames for _, frames, _ in index.shards]
    return partial(_stream, lambda shard: list(index.frames(shard)), partial(_sample, index), counts, seed)


def _stream(
    load: Callable[[int], Sequence[Frame]],
    decode: Callable[[Frame], TrainingSample],
    counts: Sequence[int],
    seed: int,
    start: int,
    stride: int,
) -> Iterator[TrainingSample]:
    held, frames, order = (-1, -1), [], np.empty(0, np.int64)
    for position in count(start, stride):
        epoch, place = divmod(position, sum(counts))
        shard, within = _locate(counts, np.random.default_rng([seed, epoch]).permutation(len(counts)), place)
        if held != (epoch, shard):
            frames, held = load(shard), (epoch, shard)
            order = np.random.default_rng([seed, epoch, shard]).permutation(counts[shard])
        yield decode(frames[int(order[within])])


def _locate(counts: Sequence[int], order: Int[np.ndarray, "n_shards"], place: int) -> tuple[int, int]:
    """(shard, frame in it) at `place` of a pass that takes the shards in `order`."""
    ends = np.cumsum([counts[k] for k in order])
    turn = int(np.searchsorted(ends, place, side="right"))
    shard = int(order[turn])
    return shard, place - int(ends[turn]) + counts[shard]


def _sample(index: ShardIndex, frame: StoredFrame) -> TrainingSample:
    label = index.label(frame)
    image = grey_8_bit(decode_image(frame.image, f"{index.place}, {frame.key}"))
    mask = decode_image(frame.mask, f"{index.place}, mask of {frame.key}") > 127
    return TrainingSample(image, label.keypoints_px, label.visibility, label.box_xyxy, mask)
