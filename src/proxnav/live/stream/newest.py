"""A queue that never grows: when it is full the oldest waits no longer, and is counted."""

from collections import deque
from collections.abc import Callable
from threading import Condition, Event
from typing import Generic, TypeVar

Item = TypeVar("Item")
_LOOK_S = 0.1


class NewestQueue(Generic[Item]):
    """Holds the newest `size` items between one thread that puts and one that takes."""

    def __init__(self, size: int) -> None:
        self._items: deque[Item] = deque()
        self._size = size
        self._changed = Condition()
        self._is_closed = False
        self.dropped = 0
        """Items that newer ones pushed out."""

    def put(self, item: Item) -> None:
        """Adds an item; the oldest leaves where there are too many."""
        with self._changed:
            if len(self._items) == self._size:
                self._items.popleft()
                self.dropped += 1
            self._items.append(item)
            self._changed.notify_all()

    def put_when_free(self, item: Item, stop: Event) -> None:
        """Adds an item once there is room: for sources that can wait. Gives up when `stop` is set."""
        with self._changed:
            while len(self._items) >= self._size and not stop.is_set():
                self._changed.wait(_LOOK_S)
            if not stop.is_set():
                self._items.append(item)
                self._changed.notify_all()

    def close(self) -> None:
        """Nothing more will be put."""
        with self._changed:
            self._is_closed = True
            self._changed.notify_all()

    def take(self, is_stopped: Callable[[], bool] = lambda: False) -> Item | None:
        """The oldest item that is still there, waiting for one; None when the queue is closed and empty, or stopped."""
        with self._changed:
            while not self._items and not self._is_closed and not is_stopped():
                self._changed.wait(_LOOK_S)
            item = self._items.popleft() if self._items and not is_stopped() else None
            self._changed.notify_all()
            return item
