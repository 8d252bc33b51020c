"""Whatever arrives is used or counted by its fault, and the next frame is taken again."""

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.images.codecs import decode_image, encode_png
from proxnav.live.frame_intake import FrameIntake

CAMERA = Camera(width=6, height=4, fx=10.0, fy=10.0, cx=3.0, cy=2.0)
IMAGE = np.zeros((4, 6), np.uint8)
PNG = encode_png(IMAGE)


def take(intake: FrameIntake, t: float, content: bytes = PNG, now: float | None = None) -> bool:
    image = intake.take(
        t, t if now is None else now, CAMERA, lambda: decode_image(content, "message") if content else None
    )
    return image is not None


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (b"", "empty"),
        (PNG[:20], "damaged"),
        (b"no image at all", "damaged"),
        (encode_png(np.zeros((8, 8), np.uint8)), "other_size"),
    ],
)
def test_what_cannot_be_read_is_counted_and_the_next_frame_is_used(content: bytes, fault: str) -> None:
    intake = FrameIntake()
    assert not take(intake, 1.0, content)
    assert intake.faults == {fault: 1}
    assert intake.reason.startswith(f"{fault}: ")
    assert take(intake, 2.0)
    assert intake.summary() == f"1 of 2 frames used; left out: 1 {fault}"


def test_repeated_late_and_stale_frames_are_told_apart() -> None:
    intake = FrameIntake(oldest_s=5.0)
    used = [take(intake, 10.0), take(intake, 10.0), take(intake, 9.0), take(intake, 11.0, now=17.0), take(intake, 12.0)]
    assert used == [True, False, False, False, True]
    assert intake.faults == {"repeated": 1, "out_of_order": 1, "stale": 1}


def test_a_source_whose_clock_began_anew_is_taken_again_after_three_frames() -> None:
    intake = FrameIntake()
    assert take(intake, 100.0)
    assert [take(intake, t) for t in (0.0, 0.1, 0.2, 0.3)] == [False, False, True, True]
    assert intake.restarts == 1


def test_single_frames_out_of_order_are_no_restart() -> None:
    intake = FrameIntake()
    for t in (10.0, 11.0, 12.0, 13.0):
        assert take(intake, t)
        assert not take(intake, t - 5.0)
    assert intake.restarts == 0


def test_a_damaged_frame_leaves_its_stamp_to_another() -> None:
    intake = FrameIntake()
    assert not take(intake, 1.0, PNG[:30])
    assert take(intake, 1.0)


def test_the_reason_of_a_damaged_frame_is_the_decoders_sentence() -> None:
    intake = FrameIntake()
    with pytest.raises(InputError, match="damaged") as error:
        decode_image(b"no image", "message")
    take(intake, 1.0, b"no image")
    assert intake.reason == f"damaged: {error.value}"
