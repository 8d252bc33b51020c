"""Videos as a source."""

from threading import Event

import cv2
import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.live.stream.assemble import StreamOptions, source_of
from proxnav.live.stream.video import VideoSource


@pytest.fixture
def video(tmp_path):
    """Six frames at 20 Hz, brighter and brighter."""
    path = tmp_path / "flight.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 20.0, (32, 24))
    for k in range(6):
        writer.write(np.full((24, 32, 3), 40 * k, np.uint8))
    writer.release()
    return path


def test_frames_of_a_video_come_in_order_with_their_times(video):
    found = [one for one in VideoSource(video, in_real_time=False).heard(Event()) if one is not None]
    assert [one.t for one in found] == pytest.approx([0.0, 0.05, 0.1, 0.15, 0.2, 0.25])  # s
    assert [abs(int(one.load().mean()) - 40 * k) < 6 for k, one in enumerate(found)] == [True] * 6
    assert found[0].load().shape == (24, 32, 3)


def test_a_file_that_is_no_video_is_refused(tmp_path):
    (tmp_path / "x.avi").write_bytes(b"no video")
    with pytest.raises(InputError, match="no video that OpenCV can read"):
        next(VideoSource(tmp_path / "x.avi", in_real_time=False).heard(Event()))


@pytest.mark.parametrize(
    ("where", "options", "says"),
    [
        ("nowhere", StreamOptions(), "no such folder or video"),
        ("camera:x", StreamOptions(), "camera:NUMBER"),
        ("camera:0", StreamOptions(frames="all"), "does not wait"),
    ],
)
def test_a_source_that_cannot_be_is_refused_in_a_sentence(where, options, says):
    with pytest.raises(InputError, match=says):
        source_of(where, options)
