"""Training samples drawn on line: each a function of its number, in streams that ranks share."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from jobs import Same
from proxnav.errors import InputError
from proxnav.learning.crops import CropConfig, CropJob, WholeFrameJob
from proxnav.learning.drawn_stream import sample_source
from proxnav.missions import load_mission

CROPS = CropConfig(load_mission("observation-10-100m").training_mission, side=64, seed=11)


def test_a_training_crop_is_a_function_of_its_number():
    first, again = CropJob(CROPS)()(5), CropJob(CROPS)()(5)
    np.testing.assert_array_equal(first.image, again.image)
    np.testing.assert_array_equal(first.keypoints_px, again.keypoints_px)


def test_a_training_crop_holds_the_target():
    make = CropJob(CROPS)()
    for index in range(4):
        sample = make(index)
        assert sample.image.shape == (64, 64)
        assert sample.has_target
        assert sample.mask is not None
        assert sample.mask.mean() > 0.01


def test_a_share_of_whole_frames_is_empty():
    make = WholeFrameJob(replace(CROPS, side=64), empty_share=0.5)()
    shown = [make(index).has_target for index in range(8)]
    assert True in shown
    assert False in shown


def test_a_stream_of_samples_can_be_entered_anywhere():
    source = sample_source(CropJob(CROPS), workers=1, repeats=2, block=4)
    whole = [sample.image for sample in islice(source(0, 1), 12)]
    late = [sample.image for sample in islice(source(5, 1), 5)]
    for image, same in zip(late, whole[5:10], strict=True):
        np.testing.assert_array_equal(image, same)
    assert not np.array_equal(whole[0], whole[8])  # after both passes comes another block


def test_learning_begins_with_the_first_few_samples():
    first = list(islice(sample_source(Same(), workers=1, repeats=2, block=512)(0, 1), 128))
    assert set(first) == set(range(64))
    late = list(islice(sample_source(Same(), workers=1, repeats=2, block=512)(1024 + 70, 1), 1024))
    assert set(late) <= set(range(512, 1536))
    assert len(set(late)) > 512


def test_ranks_draw_disjoint_samples_and_together_all_of_them():
    whole = set(range(24))
    shares = [set(islice(sample_source(Same(), workers=1, repeats=1, block=8)(rank, 2), 12)) for rank in (0, 1)]
    assert shares[0] | shares[1] == whole
    assert not shares[0] & shares[1]
    assert set(islice(sample_source(Same(), workers=1, repeats=1, block=8)(0, 1), 24)) == whole


@pytest.mark.parametrize(("workers", "repeats"), [(0, 1), (1, 0)])
def test_a_stream_without_workers_or_passes_is_refused_instead_of_waiting_for_ever(workers, repeats):
    with pytest.raises(InputError, match="at least 1"):
        sample_source(CropJob(CROPS), workers, repeats)
