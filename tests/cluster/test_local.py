import os
import signal
import subprocess
import sys
import time
from itertools import count, islice
from pathlib import Path

import pytest

from jobs import CannotBegin, DieOnce, Fail, Interrupted, Square, Threads
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


def test_a_worker_has_one_thread_and_this_process_keeps_its_own(monkeypatch):
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    monkeypatch.delenv("OPENCV_FOR_THREADS_NUM", raising=False)
    assert dict(run_jobs(Threads(), [1, 2], 2)) == {1: (1, "1"), 2: (1, "1")}
    assert "OPENBLAS_NUM_THREADS" not in os.environ


def test_workers_end_with_a_process_that_is_killed(tmp_path):
    program = f"""
import os, signal
from pathlib import Path
from jobs import LeaveName
from proxnav.cluster.local import run_jobs

if __name__ == "__main__":
    for _ in run_jobs(LeaveName(Path({str(tmp_path)!r})), [1, 2, 3, 4], 2):
        os.kill(os.getpid(), signal.SIGKILL)
"""
    (tmp_path / "program.py").write_text(program)
    places = [str(Path(__file__).parents[1]), str(Path(__file__).parents[2] / "src")]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(places)}
    ended = subprocess.run([sys.executable, str(tmp_path / "program.py")], env=environment)
    assert ended.returncode == -signal.SIGKILL
    workers = [int(path.name) for path in tmp_path.iterdir() if path.name.isdigit()]
    assert workers
    deadline = time.monotonic() + 30.0
    while any(map(is_running, workers)) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(map(is_running, workers))


def is_running(pid: int) -> bool:
    try:
        return "Z" not in Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
