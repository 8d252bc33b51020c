"""Render, estimate, filter, and look where the filter says: all rooms together on a few frames."""

from pathlib import Path

import numpy as np
import pytest

from proxnav.cli.main import main
from proxnav.closed_loop import ClosedLoopConfig, frame_times
from proxnav.datasets.sensor_records.record_files import read_records
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.models.loading import shipped_models

needs_weights = pytest.mark.skipif(not shipped_models(), reason="no shipped weights in this clone")


@needs_weights
def test_the_filter_tells_the_estimator_where_to_look(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    boxes = []
    unwatched = PoseEstimator.keypoints_and_pose

    def watched(self, image, camera, box=None):
        boxes.append(box)
        return unwatched(self, image, camera, box)

    monkeypatch.setattr(PoseEstimator, "keypoints_and_pose", watched)
    out = tmp_path / "loop"
    argv = ["simulate", "--out", str(out), "--detector", "raycast", "--start-s", "4600", "--duration-s", "10"]
    assert main([*argv, "--truth.step-s", "0.5"]) == 0
    assert boxes[0] is None
    assert boxes[-1] is not None
    assert (boxes[-1][2:] - boxes[-1][:2] > 50.0).all()  # px: 8 m at 32 m
    keypoints = read_records(out).records.keypoints
    assert keypoints is not None
    assert len(keypoints.t) >= 8
    assert np.isfinite(keypoints.pixels).mean() > 0.5
    assert main(["navigate", str(out)]) == 0
    assert "inside 3 sigma" in capsys.readouterr().out
    assert (out / "errors.png").stat().st_size > 10_000


@needs_weights
def test_a_flight_in_the_dark_is_one_sentence(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    out = str(tmp_path / "dark")
    argv = ["simulate", "--out", out, "--detector", "raycast", "--start-s", "6200", "--duration-s", "10"]
    assert main([*argv, "--truth.step-s", "0.5"]) == 1
    assert "in eclipse at all 2 instants" in capsys.readouterr().err
    assert not (tmp_path / "dark").exists()


def test_a_camera_without_rate_is_refused() -> None:
    with pytest.raises(InputError, match="rate must be positive"):
        frame_times(None, ClosedLoopConfig(rate_hz=0.0))  # type: ignore[arg-type]
