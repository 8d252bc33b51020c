"""An ephemeris that grows while the filter runs."""

import numpy as np

from proxnav.errors import InputError
from proxnav.navigation.filter_setup import LONGEST_EPHEMERIS_STEP_S, Ephemeris, in_order


def grown(ephemeris: Ephemeris, rows: Ephemeris) -> Ephemeris:
    """With rows that follow the last one. InputError for rows of the past: beliefs rest on what was given before."""
    if len(rows.t) == 0:
        return ephemeris
    if not np.min(rows.t) > ephemeris.t[-1]:
        raise InputError(
            f"an ephemeris grows forward: its last row is at {ephemeris.t[-1]:g} s, the new ones begin at "
            f"{np.min(rows.t):g} s; give later ones only"
        )
    return in_order(Ephemeris(*(np.concatenate(both) for both in zip(ephemeris, rows, strict=True))))


def reaches(ephemeris: Ephemeris, t: float) -> bool:
    """Whether the rows tell of an instant: the last piece goes on for a while."""
    return bool(ephemeris.t[0] - LONGEST_EPHEMERIS_STEP_S <= t <= ephemeris.t[-1] + LONGEST_EPHEMERIS_STEP_S)


def check_reaches(ephemeris: Ephemeris, t: float) -> None:
    """InputError where the rows do not tell of an instant."""
    if not reaches(ephemeris, t):
        raise InputError(
            f"the ephemeris covers {ephemeris.t[0]:g} to {ephemeris.t[-1]:g} s, asked for {t:g} s: extend it first"
        )
