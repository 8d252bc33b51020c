"""The video plays: as many frames as steps, even sides, and it shows what was found."""

from pathlib import Path

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.viewing.replay.of_run import read_replay
from proxnav.viewing.replay.video import draw_step, save_video

av = pytest.importorskip("av", reason="PyAV is not installed (pip install 'proxnav[view]')")


def test_a_run_becomes_a_video_of_its_steps(playable: Path, tmp_path: Path) -> None:
    save_video(read_replay(playable), tmp_path / "run.mp4", frames_per_s=4.0)
    with av.open(str(tmp_path / "run.mp4")) as container:
        (stream,) = container.streams.video
        frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(stream)]
        assert stream.codec_context.name == "h264"
        assert float(stream.average_rate) == pytest.approx(4.0)
    assert len(frames) == 5
    assert frames[0].shape == (80, 96, 3)


def test_found_keypoints_are_drawn_yellow_and_true_ones_green(playable: Path) -> None:
    replay = read_replay(playable)
    picture = draw_step(replay, replay.steps[0]).astype(int)
    red, green, blue = np.moveaxis(picture, -1, 0)
    assert ((red > 200) & (green > 150) & (blue < 100)).sum() > 10
    assert ((green > 180) & (red < 130) & (blue < 130)).sum() > 5


def test_a_flight_without_images_shows_a_sketch_of_the_target(flight: Path) -> None:
    replay = read_replay(flight)
    picture = draw_step(replay, replay.steps[-1])
    assert picture.shape == (replay.camera.height, replay.camera.width, 3)
    assert (picture[60:] > 25).any(axis=2).sum() > 500


@pytest.mark.parametrize(("rate", "side"), [(0.0, 512), (10.0, 4), (1e9, 512)])
def test_impossible_videos_are_refused(playable: Path, tmp_path: Path, rate: float, side: int) -> None:
    with pytest.raises(InputError, match="frames per second"):
        save_video(read_replay(playable), tmp_path / "run.mp4", rate, side)
    assert not list(tmp_path.glob("*.mp4"))
