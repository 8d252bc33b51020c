"""What each reading does to a belief."""

from dataclasses import replace

from proxnav.navigation.belief import Belief, Waiting
from proxnav.navigation.filter_setup import FilterSetup
from proxnav.navigation.measurements import Verdict, take_gnss, take_keypoints, take_pose, take_star_fix
from proxnav.navigation.propagate import Step, propagate, pushed, turned
from proxnav.navigation.readings import (
    Acceleration,
    GnssFix,
    GyroReading,
    KeypointFrame,
    PoseFix,
    Reading,
    StarFix,
)
from proxnav.navigation.start import disagrees_with_control, star_to_start, started

_APPLIED = Verdict("accepted")


def apply(
    belief: Belief, reading: Reading, setup: FilterSetup, steps: list[Step] | None = None
) -> tuple[Belief, Verdict]:
    """The belief after a reading, which may not be older than the belief."""
    match reading:
        case GyroReading():
            return turned(belief, reading, setup, steps), _APPLIED
        case Acceleration():
            return pushed(belief, reading, setup, steps), _APPLIED
        case _:
            return _measure(propagate(belief, reading.t, setup, steps), reading, setup)


def _measure(
    belief: Belief, reading: StarFix | GnssFix | PoseFix | KeypointFrame, setup: FilterSetup
) -> tuple[Belief, Verdict]:
    """The belief after a measurement at its own time."""
    if isinstance(reading, StarFix):
        belief = replace(belief, memory=replace(belief.memory, star=reading))
    if isinstance(reading, PoseFix):
        return _pose(belief, reading, setup)
    if isinstance(belief, Waiting):
        return belief, Verdict("not_started")
    match reading:
        case StarFix():
            return take_star_fix(belief, reading, setup)
        case GnssFix():
            return take_gnss(belief, reading, setup)
        case KeypointFrame():
            return take_keypoints(belief, reading, setup)


def _pose(belief: Belief, fix: PoseFix, setup: FilterSetup) -> tuple[Belief, Verdict]:
    """Starts the filter where it needs that; with loose coupling the pose is also measured."""
    star = star_to_start(belief)
    if star is not None:
        if disagrees_with_control(belief, star, fix, setup):
            return belief, Verdict("gated")
        belief = started(belief, star, fix, setup)
    if isinstance(belief, Waiting) or setup.config.coupling == "tight":
        return belief, Verdict("not_started" if star is None else "started")
    belief, verdict = take_pose(belief, fix, setup)
    return belief, verdict if star is None else Verdict("started", verdict.nis, verdict.dof)
