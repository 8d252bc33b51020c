"""The part of a flight in the light that its mission wants; a flight that is dark throughout is refused."""

import warnings
from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool

from proxnav.errors import InputError, InputNote
from proxnav.missions.mission import Mission
from proxnav.records import SceneSpec, Trajectory
from proxnav.trajectories.selection import observable, select

_BACKLIT_RAD = float(np.deg2rad(160.0))
"""Beyond this angle between Sun and camera a sphere shows less than 3 % of its lit half."""


def in_light(trajectory: Trajectory, mission: Mission) -> Trajectory:
    """The instants that are lit as [light] wants, all of them where it wants frames in Earth's shadow.

    Where none is, those that are lit at all, with an `InputNote`. InputError where nothing is lit.
    """
    if mission.light.umbra > 0.0:
        return trajectory
    wanted = observable(trajectory, mission.scenes.sun.max_phase_rad)
    if wanted.any():
        return select(trajectory, wanted)
    lit = seen_at_all(trajectory)
    least = np.rad2deg(trajectory.phase_rad[lit].min())
    warnings.warn(
        f"{trajectory.source}: the Sun is never within {mission.light.phase_deg[1]:g} deg from behind the camera, as "
        f"[light] phase_deg wants; the {lit.sum()} of {len(lit)} instants with it {least:.0f} deg or more are taken",
        InputNote,
        stacklevel=3,
    )
    return select(trajectory, lit)


def seen_at_all(trajectory: Trajectory) -> Bool[np.ndarray, "n_instants"]:
    """Instants at which a camera sees more than black; InputError where none is."""
    lit = observable(trajectory, _BACKLIT_RAD)
    if not lit.any():
        raise InputError(_all_dark(trajectory))
    return lit


def eclipse_line(scenes: Sequence[SceneSpec]) -> str:
    """How many frames see less than half of the Sun's disc, in a few words; empty where none does."""
    dark = sum(scene.sun.visible_fraction <= 0.5 for scene in scenes)
    return f"{dark} of {len(scenes)} frames in eclipse" if dark else ""


def _all_dark(trajectory: Trajectory) -> str:
    n = len(trajectory)
    where = "in eclipse" if (trajectory.sun_visible <= 0.5).all() else "in eclipse or lit from behind alone"
    return (
        f"{trajectory.source}: the target is {where} at all {n} instants from {trajectory.epoch_utc} on, every frame "
        "would be black; begin elsewhere on the orbit (argument_of_latitude_deg), or want it: [light] umbra above 0"
    )
