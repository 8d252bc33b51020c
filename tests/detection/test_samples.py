"""Samples and the streams they come in."""

from itertools import islice

import numpy as np
import pytest

from proxnav.detection.samples import TrainingSample, check_keypoint_count, shuffled, with_keypoints
from proxnav.errors import InputError

IMAGE = np.zeros((6, 8), np.uint8)
NOWHERE = np.full(4, np.nan)


def numbered(index: int) -> TrainingSample:
    return TrainingSample(IMAGE, np.full((1, 2), float(index)), np.array([2]), np.array([1.0, 1.0, 5.0, 5.0]))


def numbers(source, start: int, stride: int, n: int) -> list[int]:
    return [int(sample.keypoints_px[0, 0]) for sample in islice(source(start, stride), n)]


@pytest.mark.parametrize("image", [IMAGE.astype(float), IMAGE[:0], np.zeros((4, 4, 4), np.uint8)])
def test_only_eight_bit_grey_or_colour_is_learned_from(image: np.ndarray) -> None:
    with pytest.raises(InputError, match="must be uint8"):
        TrainingSample(image, np.zeros((1, 2)), np.zeros(1), NOWHERE)


def test_a_mask_of_another_size_is_refused() -> None:
    with pytest.raises(InputError, match="make them the same"):
        TrainingSample(IMAGE, np.zeros((1, 2)), np.zeros(1), NOWHERE, np.zeros((6, 9), bool))


def test_a_point_without_image_is_never_labelled() -> None:
    sample = TrainingSample(IMAGE, np.array([[np.nan, 2.0], [3.0, 4.0]]), np.array([2, 2]), NOWHERE)
    assert sample.visibility.tolist() == [0, 2]
    assert not sample.has_target


def test_a_wrong_number_of_keypoints_names_both_numbers() -> None:
    with pytest.raises(InputError, match="a sample has 1 keypoints, the network 6"):
        check_keypoint_count(numbered(0), 6)


def test_every_pass_sees_every_sample_once_in_a_new_order() -> None:
    first, second = (numbers(shuffled(numbered, 9, seed=3), start, 1, 9) for start in (0, 9))
    assert sorted(first) == sorted(second) == list(range(9))
    assert first != second


@pytest.mark.parametrize(("start", "stride"), [(0, 2), (1, 2), (13, 1), (25, 4)])
def test_a_stream_can_be_entered_anywhere(start: int, stride: int) -> None:
    whole = numbers(shuffled(numbered, 7, seed=1), 0, 1, 60)
    assert numbers(shuffled(numbered, 7, seed=1), start, stride, 8) == whole[start::stride][:8]


def test_an_unreadable_sample_is_skipped_and_reported_once(caplog: pytest.LogCaptureFixture) -> None:
    def load(index: int) -> TrainingSample:
        if index == 4:
            raise InputError("img000004.png is truncated")
        return numbered(index)

    seen = numbers(shuffled(load, 10, seed=0), 0, 1, 30)
    assert 4 not in seen
    assert seen.count(5) == 6
    assert [record.message for record in caplog.records] == ["sample 4 skipped, 1 so far: img000004.png is truncated"]


def test_a_broken_data_set_ends_the_run() -> None:
    def load(index: int) -> TrainingSample:
        raise InputError("no such file")

    with pytest.raises(InputError, match="3 of 10 samples cannot be read, the last one because: no such file"):
        numbers(shuffled(load, 10, seed=0), 0, 1, 1)


def test_a_stream_can_be_narrowed_to_a_subset_of_keypoints() -> None:
    points, seen = np.arange(8.0).reshape(4, 2), np.array([2, 1, 0, 2])
    whole = TrainingSample(IMAGE, points, seen, NOWHERE)
    narrow = next(with_keypoints(lambda start, stride: iter([whole]), (3, 1))(0, 1))
    np.testing.assert_array_equal(narrow.keypoints_px, points[[3, 1]])
    assert narrow.visibility.tolist() == [2, 1]
    with pytest.raises(InputError, match="keypoint 4 was asked for, samples have 4"):
        next(with_keypoints(lambda start, stride: iter([whole]), (4,))(0, 1))
