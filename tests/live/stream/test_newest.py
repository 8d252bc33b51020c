"""The queue that never grows."""

import threading

from proxnav.live.stream.newest import NewestQueue


def test_a_full_queue_drops_its_oldest_and_counts_it():
    queue = NewestQueue[int](2)
    for item in range(5):
        queue.put(item)
    assert (queue.take(), queue.take(), queue.dropped) == (3, 4, 3)


def test_a_closed_queue_gives_what_is_left_and_then_nothing():
    queue = NewestQueue[int](3)
    queue.put(1)
    queue.close()
    assert (queue.take(), queue.take()) == (1, None)


def test_one_that_waits_for_room_loses_nothing():
    queue, stop = NewestQueue[int](1), threading.Event()

    def put() -> None:
        for item in range(50):
            queue.put_when_free(item, stop)
        queue.close()

    threading.Thread(target=put).start()
    taken = []
    while (item := queue.take()) is not None:
        taken.append(item)
    assert taken == list(range(50))
    assert queue.dropped == 0


def test_one_that_waits_for_room_gives_up_when_it_is_stopped():
    queue, stop = NewestQueue[int](1), threading.Event()
    queue.put(0)
    stop.set()
    queue.put_when_free(1, stop)
    queue.close()
    assert (queue.take(), queue.take()) == (0, None)
