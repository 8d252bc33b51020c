from itertools import count, islice

import pytest

from jobs import DieOnce, Fail, Square
from proxnav.cluster.local import in_order, run_jobs


@pytest.mark.parametrize("workers", [1, 2])
def test_every_item_gets_its_result(workers):
    assert dict(run_jobs(Square(), list(range(20)), workers)) == {x: x * x for x in range(20)}


def test_a_killed_worker_loses_nothing(tmp_path):
    results = dict(run_jobs(DieOnce(tmp_path / "died"), list(range(12)), 2))
    assert (tmp_path / "died").exists()
    assert results == {x: -x for x in range(12)}


@pytest.mark.parametrize("workers", [1, 2])
def test_a_failing_job_ends_the_run_with_its_own_error(workers):
    with pytest.raises(ValueError, match="cannot do"):
        list(run_jobs(Fail(), [1, 2, 3], workers))


def test_an_endless_stream_keeps_its_order():
    assert list(islice(in_order(Square(), count(), 2, ahead=8), 50)) == [x * x for x in range(50)]
