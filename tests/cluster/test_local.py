from itertools import count, islice

import pytest

from jobs import CannotBegin, DieOnce, Fail, Interrupted, Square
from proxnav.cluster.local import in_order, run_jobs
from proxnav.errors import InputError


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


@pytest.mark.parametrize("workers", [1, 2])
def test_a_job_that_cannot_begin_says_why(workers):
    with pytest.raises(InputError, match="no tool here"):
        list(run_jobs(CannotBegin(), [1, 2, 3], workers))


def test_workers_leave_ctrl_c_to_the_process_they_work_for():
    assert dict(run_jobs(Interrupted(), [1, 2, 3], 2)) == {1: 1, 2: 2, 3: 3}
    assert list(islice(in_order(Interrupted(), count(), 1, ahead=2), 3)) == [0, 1, 2]
