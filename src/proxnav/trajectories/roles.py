"""Who is the target and who the chaser among the histories of some files: by name, else by order."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from proxnav.errors import InputError
from proxnav.trajectories.readers.config import ReaderConfig
from proxnav.trajectories.readers.history import AttitudeHistory, History, OrbitHistory

Kind = TypeVar("Kind", OrbitHistory, AttitudeHistory)


@dataclass(frozen=True, slots=True, eq=False)
class Roles:
    """The histories that are used; None where declared laws stand in."""

    target: OrbitHistory | None
    chaser: OrbitHistory | None
    attitude_target: AttitudeHistory | None
    attitude_chaser: AttitudeHistory | None

    @property
    def is_relative(self) -> bool:
        """Whether the chaser's positions are relative to the target."""
        return self.chaser is not None and self.chaser.frame.kind == "ric"

    @property
    def used(self) -> list[History]:
        """Those that there are; the first gives epoch and instants."""
        every = (self.target, self.chaser, self.attitude_target, self.attitude_chaser)
        return [history for history in every if history is not None]


def assigned(found: Sequence[History], config: ReaderConfig) -> Roles:
    """Roles by the names that the configuration gives, else by order; InputError where that is not enough."""
    orbits = [history for history in found if isinstance(history, OrbitHistory)]
    if not orbits:
        sources = _sources(found)
        raise InputError(f"{sources}: attitudes but no positions; give the file with the target's orbit as well")
    hill = [history for history in orbits if history.frame.kind == "ric"]
    named = [history for history in hill if config.chaser in (history.name, Path(history.source).stem)]
    absolute = [history for history in orbits if history not in hill]
    target, chaser = _roles(absolute, config.target, "" if named else config.chaser)
    relative = _only(named or hill, chaser)
    attitudes = [history for history in found if isinstance(history, AttitudeHistory)]
    of_target, of_chaser = _attitude_roles(attitudes, target, chaser, config)
    return Roles(target, relative or chaser, of_target, of_chaser if config.q_chaser_cam is not None else None)


def _roles(
    orbits: list[OrbitHistory], target_name: str, chaser_name: str
) -> tuple[OrbitHistory | None, OrbitHistory | None]:
    """(target, chaser)."""
    target, chaser = _named(orbits, target_name), _named(orbits, chaser_name)
    rest = [history for history in orbits if history is not target and history is not chaser]
    # Basilisk's two-craft tables put the servicer first.
    if target is None and chaser is None and [h.name for h in rest[:2]] == ["1", "2"]:
        rest = [rest[1], rest[0], *rest[2:]]
    if len(rest) + (target is not None) + (chaser is not None) > 2:
        names = ", ".join(history.name for history in orbits)
        raise InputError(f"{_sources(orbits)}: objects {names}; name two by --reader.target and --reader.chaser")
    if target is None and rest:
        target = rest.pop(0)
    if chaser is None and rest:
        chaser = rest.pop(0)
    return target, chaser


def _only(relative: list[OrbitHistory], chaser: OrbitHistory | None) -> OrbitHistory | None:
    """The chaser's positions relative to the target; InputError where several files or objects give its positions."""
    if len(relative) + (chaser is not None and bool(relative)) > 1:
        said = ", ".join(f"{h.name} of {h.source}" for h in [*relative, *([chaser] if chaser else [])])
        raise InputError(f"the chaser's positions are given more than once, by {said}; name one by --reader.chaser")
    return relative[0] if relative else None


def _attitude_roles(
    attitudes: list[AttitudeHistory],
    target: OrbitHistory | None,
    chaser: OrbitHistory | None,
    config: ReaderConfig,
) -> tuple[AttitudeHistory | None, AttitudeHistory | None]:
    """(target's, chaser's): by the names of roles or orbits, the rest in order."""
    names = (config.target or (target.name if target else ""), config.chaser or (chaser.name if chaser else ""))
    known = {history.name for history in attitudes}
    of_target = _named(attitudes, names[0]) if names[0] in known else None
    of_chaser = _named(attitudes, names[1]) if names[1] in known else None
    rest = [history for history in attitudes if history is not of_target and history is not of_chaser]
    if of_target is None and rest:
        of_target = rest.pop(0)
    if of_chaser is None and rest:
        of_chaser = rest.pop(0)
    return of_target, of_chaser


def _named(options: list[Kind], name: str) -> Kind | None:
    if not name:
        return None
    for history in options:
        if name in (history.name, Path(history.source).stem):
            return history
    names = ", ".join(history.name for history in options)
    raise InputError(f"no object '{name}' in the files, only {names}; correct --reader.target or --reader.chaser")


def _sources(histories: Sequence[History]) -> str:
    return ", ".join(dict.fromkeys(history.source for history in histories))
