"""A command begun twenty times and killed each time when it has written a few files; prints how many times it was.

    python killed_runs.py FOLDER WORD...

The runs are forked from this process, which has imported everything: what they do before their first frame is short.
"""

import os
import random
import signal
import sys
import time
from pathlib import Path

import proxnav.commands.render
from proxnav.cli.main import main as proxnav


def main(folder: Path, words: list[str]) -> int:
    """Times that the command was killed before it was done."""
    rng = random.Random(5)
    for killed in range(20):
        enough = written(folder) + rng.randint(1, 3)
        run = os.fork()
        if run == 0:
            os._exit(proxnav([*words, "--out", str(folder)]))
        while written(folder) < enough and not is_ended(run):
            time.sleep(0.005)
        time.sleep(rng.uniform(0.0, 0.03))  # a moment that may fall anywhere within a frame
        if is_ended(run):
            return killed
        os.kill(run, signal.SIGKILL)
        os.waitpid(run, 0)
    return 20


def written(folder: Path) -> int:
    return sum(1 for _ in folder.rglob("*.json"))


def is_ended(run: int) -> bool:
    return os.waitid(os.P_PID, run, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None


if __name__ == "__main__":
    print(main(Path(sys.argv[1]), sys.argv[2:]))
