"""Jobs on Ray: each actor builds its tool once; a node that dies loses nothing, a job that fails is named."""

import sys
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import Any

from proxnav.cluster.ray_session import ray_session
from proxnav.cluster.threads import ONE_THREAD
from proxnav.errors import InputError

_VERSION = version("proxnav")

AHEAD = 2
"""Items under way per worker: enough to keep it busy, few enough that no results pile up."""
TRIES = 3
"""Tries of an item, whether its worker died or the job failed."""
HOPELESS = 20
"""Failed items without a single success before the run gives up."""
PATIENCE_S = 300.0
"""Without any worker before the run gives up: a cluster may still be growing."""


class Worker:
    """Lives in a process of the cluster; says what went wrong as values, so that no foreign exception has to travel."""

    def __init__(self, make_job: Callable[[], Callable[[Any], Any]]) -> None:
        self._job: Callable[[Any], Any] | None = None
        self._make_job = make_job

    def begin(self) -> tuple[str, Any]:
        """Builds the tool; ("ready", version), or why not."""
        try:
            self._job = self._make_job()
        except Exception as error:
            return _said(error)
        return "ready", _VERSION

    def run(self, item: Any) -> tuple[str, Any]:
        """("done", result), or ("refused" | "failed", a sentence)."""
        assert self._job is not None
        try:
            return "done", self._job(item)
        except Exception as error:
            return _said(error)


def _said(error: Exception) -> tuple[str, str]:
    if isinstance(error, InputError):
        return "refused", str(error)
    return "failed", " ".join(f"{type(error).__name__}: {error}".split())[:300]


@dataclass
class _Item:
    value: Any
    tries: int = 0
    turn: int = 0
    """When it was handed out, among all: an actor works on the earliest of its items."""


@dataclass
class _Crew:
    """The actors and what each of them has in hand; an entry without an item is an actor that is still beginning."""

    ray: Any
    make: Callable[[], Any]
    send: Callable[[Any], Any]
    in_hand: dict[Any, tuple[Any, _Item | None]] = field(default_factory=dict)
    ready: list[Any] = field(default_factory=list)
    turns: int = 0

    def hire(self) -> None:
        """One more actor; it gets items once it has said that it is ready."""
        actor = self.make()
        self.in_hand[actor.begin.remote()] = (actor, None)

    def dismiss(self, actor: Any) -> list[_Item]:
        """Forgets a dead actor; the items that it held."""
        lost = [(ref, item) for ref, (owner, item) in self.in_hand.items() if owner is actor]
        for ref, _ in lost:
            del self.in_hand[ref]
        if actor in self.ready:
            self.ready.remove(actor)
        return [item for _, item in lost if item is not None]

    def feed(self, waiting: deque[_Item]) -> None:
        """Hands waiting items to the actors that hold fewest, up to `AHEAD` each."""
        load = {id(actor): 0 for actor in self.ready}
        for actor, item in self.in_hand.values():
            if item is not None:
                load[id(actor)] += 1
        while waiting and load and min(load.values()) < AHEAD:
            actor = min(self.ready, key=lambda one: load[id(one)])
            item = waiting.popleft()
            self.turns += 1
            item.tries, item.turn = item.tries + 1, self.turns
            load[id(actor)] += 1
            self.in_hand[actor.run.remote(self.send(item.value))] = (actor, item)

    @property
    def busy(self) -> bool:
        """Whether any item is under way."""
        return any(item is not None for _, item in self.in_hand.values())


def run_on_ray(
    make_job: Callable[[], Callable[[Any], Any]],
    items: Sequence[Any],
    workers: int,
    address: str | None,
    name: Callable[[Any], str] = repr,
    send: Callable[[Any], Any] | None = None,
) -> Iterator[tuple[Any, Any]]:
    """(item, result) as they finish; every item gives one result, whatever dies meanwhile.

    A job's own InputError ends the run. Another failure is tried `TRIES` times, then written to stderr in one line; the
    other items go on, and InputError counts the failed ones at the end.
    """
    if not items:
        return
    with ray_session(address, workers) as ray:
        count = min(workers or int(ray.cluster_resources().get("CPU", 1)), len(items))
        # A worker that waits for a free processor must not keep the run from ending: it has no items yet.
        surroundings = {"env_vars": ONE_THREAD}
        actor = ray.remote(num_cpus=1, max_restarts=0, max_task_retries=0, runtime_env=surroundings)(Worker)
        job = ray.put(make_job)
        crew = _Crew(ray, lambda: actor.remote(job), send or (lambda item: item))
        for _ in range(count):
            crew.hire()
        yield from _work_off(crew, deque(_Item(item) for item in items), name)


def _work_off(crew: _Crew, waiting: deque[_Item], name: Callable[[Any], str]) -> Iterator[tuple[Any, Any]]:
    done, failed, idle_s = 0, 0, 0.0
    while waiting or crew.busy:
        crew.feed(waiting)
        finished, _ = crew.ray.wait(list(crew.in_hand), num_returns=1, timeout=1.0)
        idle_s = 0.0 if finished or crew.ready else idle_s + 1.0
        if idle_s > PATIENCE_S:
            raise InputError(f"no processor of the Ray cluster was free for {PATIENCE_S:.0f} s; add nodes or try later")
        for ref in finished:
            if ref not in crew.in_hand:  # its actor died with another of its items
                continue
            actor, item = crew.in_hand[ref]
            status, value = _outcome(crew, ref)
            if status == "done" and item is not None:
                done += 1
                yield item.value, value
            elif status == "died":
                failed += _again(waiting, _lost(crew, actor, item), value, name)
            elif status == "failed" and item is not None:
                failed += _again(waiting, [item], value, name)
            if failed >= HOPELESS and not done:
                raise InputError(f"the first {failed} jobs failed, none succeeded; the last one: {value}")
    if failed:
        raise InputError(
            f"{failed} of {done + failed} jobs failed, each named above; the same command tries them again"
        )


def _outcome(crew: _Crew, ref: Any) -> tuple[str, Any]:
    """What an actor said, or that it died; a refusal ends the run."""
    actor, item = crew.in_hand.pop(ref)
    try:
        status, value = crew.ray.get(ref)
    except crew.ray.exceptions.RayError as error:
        return "died", f"its worker died ({type(error).__name__})"
    if status == "refused" or (status == "failed" and item is None):
        raise InputError(value)
    if status == "ready":
        if value != _VERSION:
            raise InputError(f"a worker has proxnav {value}, this is {_VERSION}: results could differ; update it")
        crew.ready.append(actor)
    return status, value


def _lost(crew: _Crew, actor: Any, item: _Item | None) -> list[_Item]:
    """The items of an actor that died, of which only the one it worked on has had a try; another actor is hired."""
    items = crew.dismiss(actor) + ([item] if item else [])
    items.sort(key=lambda one: one.turn)
    for innocent in items[1:]:
        innocent.tries -= 1
    crew.hire()
    return items


def _again(waiting: deque[_Item], items: list[_Item], why: str, name: Callable[[Any], str]) -> int:
    """Puts items back in line; those that had their tries are named on stderr, and counted."""
    failed = 0
    for item in items:
        if item.tries < TRIES:
            waiting.appendleft(item)
        else:
            failed += 1
            print(f"{name(item.value)[:120]} failed {item.tries} times: {why}", file=sys.stderr)
    return failed
