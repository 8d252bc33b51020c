"""Other time systems' instants in UTC: leap seconds and TDB by ERFA, the IAU's routines.

Constants: GPS = TAI - 19 s, TT = TAI + 32.184 s.
"""

from typing import Literal, get_args

import erfa
import numpy as np

from proxnav.errors import InputError
from proxnav.geometry.epochs import DAY_S, Instant, instant

TimeSystem = Literal["UTC", "TAI", "GPS", "TT", "TDB"]

_MJD_JD = 2400000.5
_TAI_MINUS = {"TAI": 0.0, "GPS": 19.0, "TT": -32.184, "TDB": -32.184}
"""TAI less that system [s], TDB's periodic terms left to `_tdb_less_tt`."""


def time_system(name: str) -> TimeSystem | None:
    """The time system that a file names; None where it is unknown.

    >>> time_system("utc"), time_system("MET")
    ('UTC', None)
    """
    return next((system for system in get_args(TimeSystem) if system == name.strip().upper()), None)


def to_utc(moment: Instant, system: TimeSystem) -> Instant:
    """The UTC instant of a clock reading in another system; InputError before 1972, when UTC had no whole seconds.

    >>> to_utc(instant(2024, 11, 1, 18.0), "GPS").iso()
    '2024-11-01T00:00:00Z'
    """
    if system == "UTC":
        return moment
    tai = moment.plus(_TAI_MINUS[system] - (_tdb_less_tt(moment) if system == "TDB" else 0.0))
    starts, offsets = _leap_seconds()
    reached = [offset for start, offset in zip(starts, offsets, strict=True) if tai - start >= offset]
    if not reached:
        raise InputError(f"{moment.iso()} ({system}) is before UTC counts whole seconds; use instants from 1972 on")
    return tai.plus(-reached[-1])


def tt_from_utc(moment: Instant) -> Instant:
    """Terrestrial time of a UTC instant."""
    starts, offsets = _leap_seconds()
    return moment.plus(float(offsets[max(sum(moment >= start for start in starts) - 1, 0)]) + 32.184)


def _leap_seconds() -> tuple[list[Instant], list[float]]:
    """(UTC instants, TAI - UTC from then on [s]), from 1972 on."""
    table = erfa.leap_seconds.get()
    table = table[table["year"] >= 1972]
    return [instant(int(y), int(m), 1) for y, m in zip(table["year"], table["month"], strict=True)], table[
        "tai_utc"
    ].tolist()


def _tdb_less_tt(moment: Instant) -> float:
    """TDB - TT [s] at Earth's centre, within 2 ms of zero (Fairhead and Bretagnon, 1990)."""
    return float(erfa.dtdb(_MJD_JD + moment.mjd, moment.second / DAY_S, np.mod(moment.second / DAY_S, 1.0), 0, 0, 0))
