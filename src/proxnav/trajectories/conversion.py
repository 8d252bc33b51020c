"""Trajectory files from one format to another: what they hold of target and chaser, nothing that they do not hold."""

import warnings
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from proxnav.errors import InputError, InputNote
from proxnav.records import Trajectory
from proxnav.trajectories import write
from proxnav.trajectories.read import read_trajectory
from proxnav.trajectories.readers.config import ReaderConfig
from proxnav.trajectories.readers.history import OrbitHistory
from proxnav.trajectories.readers.recognise import read_files
from proxnav.trajectories.write import Craft

FORMATS = ("stk", "ccsds", "csv")
_SUFFIXES = {".e", ".a", ".oem", ".aem", ".bsp", ".bc"}


def is_trajectory(paths: Sequence[Path]) -> bool:
    """Whether these are the files of one trajectory by their number and names."""
    return len(paths) > 1 or paths[0].suffix.lower() in _SUFFIXES


def convert_trajectory(paths: Sequence[Path], to: str, out: Path, config: ReaderConfig) -> str:
    """Writes the trajectory that the files hold into the folder `out`; what was written, in a sentence."""
    orbits, attitudes = _held(paths, config)
    if len(attitudes) > 1 and config.q_chaser_cam is None:
        config = replace(config, q_chaser_cam=(1.0, 0.0, 0.0, 0.0))  # the chaser's own attitude, not a pointing one
    trajectory = read_trajectory(paths, config)
    contents = _files(trajectory, to, orbits, attitudes)
    taken = [name for name in contents if (out / name).exists()]
    if taken:
        raise InputError(f"{out / taken[0]}: exists; give another --out")
    out.mkdir(parents=True, exist_ok=True)
    for name, text in contents.items():
        (out / name).write_text(text, encoding="utf-8")
    return f"{len(trajectory)} instants from {trajectory.epoch_utc} in {out}: {', '.join(contents)}"


def _held(paths: Sequence[Path], config: ReaderConfig) -> tuple[list[Craft], list[Craft]]:
    """Whose orbits and whose attitudes the files hold; a relative orbit is the chaser's about an assumed target's."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", InputNote)  # said when the trajectory is read
        found = read_files(paths, config)
    orbits = [history for history in found if isinstance(history, OrbitHistory)]
    relative = any(history.frame.kind == "ric" for history in orbits)
    both: list[Craft] = ["target", "chaser"]
    return both if relative else both[: len(orbits)], both[: len(found) - len(orbits)]


def _files(trajectory: Trajectory, to: str, orbits: list[Craft], attitudes: list[Craft]) -> dict[str, str]:
    """File name to content."""
    if to == "csv":
        return {"trajectory.csv": write.csv(trajectory, orbits, attitudes)}
    if to == "stk":
        found = {f"{craft}.e": write.stk_ephemeris(trajectory, craft) for craft in orbits}
        return found | {f"{craft}.a": write.stk_attitude(trajectory, craft) for craft in attitudes}
    found = {f"{craft}.oem": write.oem(trajectory, craft) for craft in orbits}
    return found | {f"{craft}.aem": write.aem(trajectory, craft) for craft in attitudes}
