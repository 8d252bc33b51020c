"""One call for jobs wherever they run: processes of this machine, or Ray on this or on many machines."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar

from proxnav.cluster.local import run_jobs
from proxnav.errors import InputError

Item = TypeVar("Item")
Result = TypeVar("Result")

POOL = "pool"
"""The default: processes of this machine."""


def check_place(on: str) -> None:
    """InputError unless `on` is pool, ray, or ray://host:port."""
    host, _, port = on.removeprefix("ray://").rpartition(":")
    if on not in (POOL, "ray") and not (on.startswith("ray://") and host and port.isdigit()):
        raise InputError(f"--on {on}: expected pool, ray (Ray on this machine) or ray://host:port (a running cluster)")


def check_workers(workers: int, on: str) -> None:
    """InputError unless so many workers can be had there: a cluster may be asked for all it has by 0."""
    check_place(on)
    if workers < (on == POOL):
        raise InputError(f"--workers must be at least 1, found {workers}; 0 is for a Ray cluster, all its processors")


def is_elsewhere(on: str) -> bool:
    """Whether the workers may be on other machines, which do not see this one's files."""
    return on != POOL


def run_anywhere(
    make_job: Callable[[], Callable[[Item], Result]],
    items: Sequence[Item],
    workers: int = 1,
    on: str = POOL,
    name: Callable[[Item], str] = repr,
    send: Callable[[Item], Any] | None = None,
) -> Iterator[tuple[Item, Result]]:
    """(item, result) as they finish; `on` chooses the place, the results do not depend on it.

    `name` is what a failed item is called, `send` what travels in its place to workers on Ray. There, `workers` 0 takes
    every processor of the cluster.
    """
    check_place(on)
    if on == POOL:
        return run_jobs(make_job, items, workers)
    from proxnav.cluster.ray_jobs import run_on_ray

    return run_on_ray(make_job, items, workers, None if on == "ray" else on, name, send)
