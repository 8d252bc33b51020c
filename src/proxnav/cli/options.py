"""Options that several commands share: such a command's dataclass is derived from the one that holds them."""

from dataclasses import dataclass

from proxnav.cluster.jobs import POOL, check_workers


@dataclass(frozen=True, kw_only=True)
class WorkerOptions:
    """How many jobs run at a time, and where."""

    workers: int = 1
    """Processes; on a Ray cluster, 0 takes every processor."""
    on: str = POOL
    """pool (processes of this machine), ray, or ray://host:port."""

    def check(self) -> None:
        """InputError unless so many workers can be had there; the command line asks before it runs the command."""
        check_workers(self.workers, self.on)
