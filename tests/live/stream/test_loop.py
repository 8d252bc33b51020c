"""The loop under garbage: slow estimators, stale, damaged and wrong-size images, sources that fail or go away."""

import time
from collections.abc import Iterator
from dataclasses import dataclass
from threading import Event

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.geometry.types import Image
from proxnav.live.stream.answers import Answer, Tally
from proxnav.live.stream.arrivals import Arrival, Back, Gone, Heard
from proxnav.live.stream.loop import Loop
from proxnav.records import PoseResult

CAMERA = Camera(32, 24, 40.0, 40.0, 16.0, 12.0)
IMAGE = np.zeros((24, 32), np.uint8)
POSE = Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [0, 0, 9])


@dataclass
class Listed:
    """A source that says what it is told to, and may fail at the end."""

    said: list[Heard]
    error: Exception | None = None

    def heard(self, stop: Event) -> Iterator[Heard | None]:
        yield from self.said
        if self.error is not None:
            raise self.error


def image_at(t: float, image: Image = IMAGE) -> Arrival:
    return Arrival(f"{t:g}.png", t, time.monotonic(), lambda: image)


def damaged(t: float, says: str) -> Arrival:
    def load() -> Image:
        raise InputError(f"{t:g}.png: {says}")

    return Arrival(f"{t:g}.png", t, time.monotonic(), load)


def ran(source: Listed, frames="all", slow_s: float = 0.0) -> tuple[list[Answer], Tally, list[str]]:
    answers: list[Answer] = []
    said: list[str] = []

    def estimate(image: Image, camera: Camera, t: float) -> PoseResult:
        time.sleep(slow_s)
        return PoseResult("ok", POSE, np.eye(6), np.zeros(0, bool))

    tally = Tally()
    Loop(CAMERA, estimate, [lambda answer, _: answers.append(answer)], said.append, frames=frames).run(source, tally)
    return answers, tally, said


def test_every_image_of_a_source_that_waits_is_answered():
    answers, tally, said = ran(Listed([image_at(t) for t in range(20)]), slow_s=0.001)
    assert [answer.t for answer in answers] == list(range(20))
    assert (tally.statuses, tally.refused["dropped"], said) == ({"ok": 20}, 0, [])


def test_a_slow_estimator_answers_the_newest_and_counts_what_it_dropped():
    answers, tally, _ = ran(Listed([image_at(t) for t in range(200)]), "newest", slow_s=0.02)
    assert answers[-1].t == 199
    assert len(answers) + tally.refused["dropped"] == 200
    assert tally.refused["dropped"] > 100
    assert "dropped" in tally.text()


def test_images_that_are_not_newer_than_the_last_one_are_left_out():
    answers, tally, said = ran(Listed([image_at(t) for t in (1.0, 3.0, 2.0, 3.0, 4.0)]))
    assert [answer.t for answer in answers] == [1.0, 3.0, 4.0]
    assert tally.refused["stale"] == 2
    assert "not newer" in said[0]


def test_damaged_and_wrong_size_images_are_counted_said_and_survived():
    large = np.zeros((40, 40), np.uint8)
    garbage = [damaged(2, "empty"), damaged(3, "truncated"), damaged(4, "not a readable image"), image_at(5, large)]
    answers, tally, said = ran(Listed([image_at(1), *garbage, image_at(6)]))
    assert [answer.t for answer in answers] == [1, 6]
    counts = {name: count for name, count in tally.refused.items() if count}
    assert counts == {"empty": 1, "truncated": 1, "unreadable": 1, "wrong size": 1}
    assert len(said) == 4
    assert "40x40 px" in said[3]


def test_a_source_that_goes_and_comes_back_is_counted_and_said():
    answers, tally, said = ran(Listed([image_at(1), Gone("unplugged"), Back(), image_at(2)]))
    assert len(answers) == 2
    assert (tally.losses, tally.returns) == (1, 1)
    assert "unplugged" in said[0]
    assert "went away 1 time(s)" in tally.text()


def test_what_makes_a_source_fail_is_raised_after_what_it_gave_was_answered():
    answers: list[Answer] = []
    loop = Loop(CAMERA, lambda *_: PoseResult.failure("no_target", 0), [lambda a, _: answers.append(a)], print)
    with pytest.raises(InputError, match="no such camera"):
        loop.run(Listed([image_at(1)], InputError("no such camera")), Tally())
    assert [answer.result.status for answer in answers] == ["no_target"]


def test_an_interrupt_stops_the_source_and_keeps_the_counts():
    stopped = Event()

    class Endless:
        def heard(self, stop: Event) -> Iterator[Heard | None]:
            t = 0.0
            while not stop.is_set():
                t += 1.0
                yield image_at(t)
            stopped.set()

    asked = Event()

    def interrupt(answer: Answer, _: Image) -> None:
        if answer.t > 3.0:
            asked.set()

    tally = Tally()
    loop = Loop(CAMERA, lambda *_: PoseResult.failure("lost", 0), [interrupt], print)
    loop.run(Endless(), tally, asked.is_set)
    assert stopped.wait(5.0)
    assert sum(tally.statuses.values()) > 0


def test_latencies_of_a_stream_without_end_take_no_more_room():
    tally = Tally()
    answer = Answer("x", 0.0, PoseResult.failure("lost", 0), 0.1)
    for _ in range(10_050):
        tally.answered(answer)
    assert len(tally.latencies_s) == 10_000
