"""The same image under two names: `lightbox/img12.jpg` here, `img12.jpg` or BOP's `000012.png` there; the same
instant of two trajectories.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import PurePosixPath

import numpy as np

from proxnav.datasets.formats.bop import image_number
from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.errors import InputError

SAME_INSTANT_S = 0.01
"""Times nearer to each other are the same, as evo has it."""


def named_as(truth: Mapping[str, PoseRecord], estimates: Mapping[str, PoseRecord]) -> dict[str, PoseRecord]:
    """The estimates under the truth's names, where their own are unknown to it and another reading fits all of them.

    Readings: the name without folders; the image number, where one side has nothing but numbers for names (BOP).
    """
    if all(name in truth for name in estimates):
        return dict(estimates)
    readings: list[Callable[[str], object]] = [lambda name: PurePosixPath(name).name]
    if _numeric(truth) or _numeric(estimates):
        readings.append(image_number)
    for reading in readings:
        names = _translation(truth, estimates, reading)
        if names is not None:
            return {names[name]: replace(record, filename=names[name]) for name, record in estimates.items()}
    return dict(estimates)


def at_times_of(truth: Mapping[str, PoseRecord], estimates: Mapping[str, PoseRecord]) -> dict[str, PoseRecord]:
    """The estimates under the truth's names, both being times: the nearest within 10 ms; others are left out."""
    names = sorted(truth, key=float)
    known = np.array([float(name) for name in names])
    found: dict[str, PoseRecord] = {}
    for name, record in estimates.items():
        nearest = names[int(np.abs(known - float(name)).argmin())]
        if abs(float(nearest) - float(name)) <= SAME_INSTANT_S and nearest not in found:
            found[nearest] = replace(record, filename=nearest)
    if not found:
        raise InputError(f"no estimate is within {SAME_INSTANT_S * 1e3:g} ms of a time of the truth; check both clocks")
    return found


def _translation(
    truth: Mapping[str, PoseRecord], estimates: Mapping[str, PoseRecord], reading: Callable[[str], object]
) -> dict[str, str] | None:
    """Estimate's name to truth's name; None where the reading is ambiguous or leaves an estimate over."""
    try:
        known, asked = {reading(name): name for name in truth}, {name: reading(name) for name in estimates}
    except InputError:
        return None
    unique = len(known) == len(truth) and len(set(asked.values())) == len(asked)
    if not unique or not all(value in known for value in asked.values()):
        return None
    return {name: known[value] for name, value in asked.items()}


def _numeric(records: Mapping[str, PoseRecord]) -> bool:
    return all(PurePosixPath(name).stem.isdecimal() for name in records)
