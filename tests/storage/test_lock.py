"""Two runs never write into one folder, and a dead run locks nothing."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from proxnav.errors import InputError
from proxnav.storage.lock import LOCK, only_run_in

HOLD = """
import sys, time
from pathlib import Path
from proxnav.storage.lock import only_run_in
with only_run_in(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


def test_a_second_run_is_refused_while_the_first_lives_and_not_after_it_was_killed(tmp_path: Path) -> None:
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2] / "src")}
    first = subprocess.Popen([sys.executable, "-c", HOLD, str(tmp_path / "run")], env=environment, stdout=-1, text=True)
    assert first.stdout is not None
    assert first.stdout.readline() == "held\n"
    with pytest.raises(InputError, match=f"process {first.pid} on .* writes into it"), only_run_in(tmp_path / "run"):
        pass
    first.send_signal(signal.SIGKILL)
    first.communicate()
    assert (tmp_path / "run" / LOCK).exists()
    with only_run_in(tmp_path / "run"):
        assert str(os.getpid()) in (tmp_path / "run" / LOCK).read_text()
    assert list((tmp_path / "run").iterdir()) == []


def test_the_same_process_is_no_exception(tmp_path: Path) -> None:
    with only_run_in(tmp_path), pytest.raises(InputError, match="writes into it"), only_run_in(tmp_path):
        pass


def test_a_folder_that_cannot_be_made_is_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    with pytest.raises(InputError, match="cannot be written"), only_run_in(tmp_path / "file" / "run"):
        pass
