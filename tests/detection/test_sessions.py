"""Networks may come and go in a process, and signals still arrive."""

import subprocess
import sys

import pytest

COME_AND_GO = """
import gc, signal, sys
from pathlib import Path
import proxnav
from proxnav.detection.sessions import open_session

signal.signal(signal.SIGINT, signal.default_int_handler)  # who started the tests may ignore it
path = Path(proxnav.__file__).parent / "weights" / "space-rider" / "finder.onnx"
first, second = (open_session(path, "openvino", 1) for _ in range(2))
for _ in range(3):
    first, second = second, open_session(path, "openvino", 1)
    gc.collect()
del first, second
gc.collect()
try:
    signal.raise_signal(signal.SIGINT)
except KeyboardInterrupt:
    sys.exit(7)
"""


def test_a_signal_after_networks_came_and_went_is_no_crash() -> None:
    pytest.importorskip("openvino", reason="openvino is not installed")
    ended = subprocess.run([sys.executable, "-c", COME_AND_GO], capture_output=True, text=True)
    assert ended.returncode == 7, ended.stderr
