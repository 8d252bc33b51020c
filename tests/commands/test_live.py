"""`proxnav live` on a folder of painted pictures, followed without a network."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from boxcraft import boxcraft
from painted_box import CAMERA, painted
from proxnav.cli.main import main
from proxnav.geometry import Pose, quaternion, so3
from proxnav.geometry.camera_files import speed_json
from proxnav.images.codecs import encode_png
from proxnav.targets.target_files import save_target

FIRST = Pose("cam", "target", quaternion.exp(np.array([0.5, -0.7, 0.3])), np.array([0.2, -0.1, 9.0]))
NUMBERS = [f"{x:.6f}" for x in (*FIRST.q_wxyz, *FIRST.t_m)]


@pytest.fixture
def folder(tmp_path):
    """Three good frames with an empty, a truncated and a wrong-size one between them."""
    images = tmp_path / "images"
    images.mkdir()
    for k in (0, 1, 5):
        turned = Pose.from_matrix("cam", "target", so3.exp(k * np.deg2rad([1.0, -2.0, 0.5])) @ FIRST.R, FIRST.t_m)
        (images / f"{k}.png").write_bytes(encode_png(painted(turned)))
    (images / "2.png").write_bytes(b"")
    (images / "3.png").write_bytes(encode_png(painted(FIRST))[:200])
    (images / "4.png").write_bytes(encode_png(np.zeros((10, 10), np.uint8)))
    (tmp_path / "camera.json").write_text(json.dumps(speed_json(CAMERA)))
    save_target(boxcraft(), tmp_path / "box")
    return tmp_path


def words(folder, *more: str) -> list[str]:
    track = ["--target", str(folder / "box"), "--first-pose", *NUMBERS]
    return ["live", str(folder / "images"), "--times", "name", "--frames", "all", *track, *more]


def test_a_folder_with_garbage_is_answered_to_its_end_and_summed_up(folder, capsys):
    assert main(words(folder, "--idle-s", "0.2", "--out", str(folder / "poses.jsonl"))) == 0
    answers = [json.loads(line) for line in (folder / "poses.jsonl").read_text().splitlines()]
    assert [(one["name"], one["status"]) for one in answers] == [("0.png", "ok"), ("1.png", "ok"), ("5.png", "ok")]
    out, err = capsys.readouterr()
    assert "3 poses from 3 images" in out
    assert "not answered: 3" in out
    assert all(f"{k}.png" in err for k in (2, 3, 4))


@pytest.mark.slow
def test_an_interrupt_ends_it_with_a_summary_and_status_0(folder):
    code = "import sys; from proxnav.cli.main import console; sys.exit(console())"
    run = subprocess.Popen(
        [sys.executable, "-c", code, *words(folder)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )  # fmt: skip
    assert run.stdout is not None
    assert json.loads(run.stdout.readline())["name"] == "0.png"
    time.sleep(0.1)
    run.send_signal(signal.SIGINT)
    _, err = run.communicate(timeout=120)
    assert run.returncode == 0
    assert "interrupted" in err
    assert "poses from" in err


@pytest.mark.parametrize(
    ("more", "says"),
    [
        (("--waiting", "0"), "--waiting must be at least 1"),
        (("--out", "poses.txt"), "as .jsonl, .csv or .mcap"),
        (("--model", "space-rider"), "knows space-rider"),
    ],
)
def test_what_cannot_be_is_one_sentence(folder, capsys, more, says):
    assert main(words(folder, *more)) == 1
    assert says in capsys.readouterr().err
