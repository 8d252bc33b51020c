"""What speaks against a navigation solution, in sentences, and the filter's events."""

from typing import Any

from proxnav.evaluation.navigation_errors import outcomes
from proxnav.navigation.navigator import Navigated

_MOST_RESTARTS = 2
_LEAST_READINGS, _MAJORITY = 20, 0.5


def doubts_of(found: Navigated) -> tuple[str, ...]:
    """Contradictions between sensors, a filter that never started, repeated restarts, sensors mostly refused."""
    counts, memory = outcomes(found.judged), found.belief.memory
    doubts = [f"from t = {finding.t:.0f} s: {finding.cause}" for finding in found.findings]
    if memory.starts == 0:
        doubts.append(_never_started(counts.get("poses", {})))
    if len(memory.restarts) > _MOST_RESTARTS:
        doubts.append(f"the filter started {memory.starts} times, the last time because {memory.restarts[-1].cause}")
    for sensor, row in counts.items():
        refused, taken = row.get("gated", 0), row.get("accepted", 0) + row.get("gated", 0)
        if taken >= _LEAST_READINGS and refused > _MAJORITY * taken:
            doubts.append(f"{refused} of {taken} readings of {sensor} were refused: they contradict the rest")
    return tuple(doubts)


def events(found: Navigated) -> dict[str, Any]:
    """What happened on the way, as summary.json says it."""
    return {
        "suspect": [{"t_s": f.t, "sensors": f.kind, "cause": f.cause} for f in found.findings],
        "restarts": [{"t_s": r.t, "cause": r.cause} for r in found.belief.memory.restarts],
        "compared": list(found.compared),
    }


def _never_started(poses: dict[str, int]) -> str:
    """A pose starts the filter where a star tracker fix is near and the target stands as it is held."""
    gated, without = poses.get("gated", 0), poses.get("not_started", 0)
    offered = sum(poses.values())
    if gated > without:
        why = (
            f"{gated} of {offered} poses show the target in another attitude than it should hold "
            "(--filter.held.q-lvlh-target, or --filter.target free)"
        )
    elif without:
        why = f"{without} of {offered} poses had no star tracker fix within 5 s before them"
    else:
        why = "no pose came" if not offered else f"none of {offered} poses could be used"
    return f"the filter never started: {why}"
