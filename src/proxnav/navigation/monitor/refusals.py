"""Measurements that the filter refuses: majorities and repeated restarts, whatever their cause."""

from dataclasses import dataclass, replace

from proxnav.navigation.belief import Memory
from proxnav.navigation.measurements import Verdict
from proxnav.navigation.monitor.finding import Finding
from proxnav.navigation.readings import ORDER, Reading, SensorName

_WINDOW_S = 60.0
_LEAST, _MAJORITY = 20, 0.8
_MOST_RESTARTS, _WITHIN_S = 3, 600.0


@dataclass(frozen=True, slots=True)
class Refusals:
    """The last minute of verdicts, and what they led to."""

    recent: tuple[tuple[float, SensorName, bool], ...] = ()
    """(time, sensor, whether refused), in the order in which they were settled."""
    findings: tuple[Finding, ...] = ()

    def also(self, reading: Reading, verdict: Verdict) -> "Refusals":
        """With one more verdict."""
        if verdict.outcome not in ("accepted", "gated"):
            return self
        return replace(self, recent=(*self.recent, (reading.t, reading.sensor, verdict.outcome == "gated")))

    def judged(self, now: float, memory: Memory) -> "Refusals":
        """With findings where a sensor's readings are mostly refused, or the filter starts again and again."""
        recent = tuple(row for row in self.recent if row[0] > now - _WINDOW_S)
        found = {finding.kind: finding for finding in self.findings}
        for sensor in ORDER:
            verdicts = [refused for _, name, refused in recent if name == sensor]
            kind, count = f"{sensor} against the filter", sum(verdicts)
            if len(verdicts) >= _LEAST and count > _MAJORITY * len(verdicts) and kind not in found:
                cause = f"{count} of the last {len(verdicts)} readings of {sensor} were refused: they contradict others"
                found[kind] = Finding(now, kind, cause)
        again = [restart for restart in memory.restarts if restart.t > now - _WITHIN_S]
        if len(again) >= _MOST_RESTARTS and "restarts" not in found:
            cause = f"the filter started anew {len(again)} times in {_WITHIN_S:.0f} s: at last  {again[-1].cause}"
            found["restarts"] = Finding(now, "restarts", cause)
        return Refusals(recent, tuple(found.values()))
