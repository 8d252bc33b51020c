"""What is said about one image that came, and what became of all."""

from collections import Counter, deque
from dataclasses import dataclass, field

from proxnav.records import NavState, PoseResult


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """Pose of one image, with the filter's state where one runs."""

    name: str
    t: float
    """When the image was taken [s]."""
    result: PoseResult
    latency_s: float
    """From when the source had the image until the answer."""
    state: NavState | None = None
    """What the filter believes after it."""


@dataclass(slots=True)
class Tally:
    """What came, and what became of it."""

    statuses: Counter[str] = field(default_factory=Counter)
    """Answers by the status of their pose."""
    refused: Counter[str] = field(default_factory=Counter)
    """Images without an answer: `dropped` (older than what waited), `stale` (not newer than the last answer), `empty`,
    `truncated`, `unreadable`, `wrong size`."""
    losses: int = 0
    """How often the source went away."""
    returns: int = 0
    latencies_s: deque[float] = field(default_factory=lambda: deque(maxlen=10_000))
    """Latencies of the last answers [s]."""

    def answered(self, answer: Answer) -> None:
        """Counts an answer."""
        self.statuses[answer.result.status] += 1
        self.latencies_s.append(answer.latency_s)

    def text(self) -> str:
        """The counts for people."""
        total, poses = sum(self.statuses.values()), self.statuses["ok"]
        lines = [f"{poses} poses from {total} images{_list(self.statuses, 'ok')}"]
        if self.latencies_s:
            ordered = sorted(self.latencies_s)
            p95 = ordered[min(len(ordered) - 1, int(0.95 * len(ordered)))]
            lines.append(f"latency: median {1e3 * ordered[len(ordered) // 2]:.0f} ms, 95 % within {1e3 * p95:.0f} ms")
        if self.refused:
            lines.append(f"not answered: {sum(self.refused.values())}{_list(self.refused)}")
        if self.losses:
            lines.append(f"the source went away {self.losses} time(s) and came back {self.returns} time(s)")
        return "\n".join(lines)


def _list(counts: Counter[str], but: str = "") -> str:
    found = [f"{count} {name}" for name, count in counts.most_common() if name != but and count]
    return f" ({', '.join(found)})" if found else ""
