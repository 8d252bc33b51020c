"""Instants in UTC: a whole day and a second within it, so that differences stay exact over decades.

Days have 86 400 s: a span across a leap second (the last one was on 2016-12-31) is one second short.
"""

import re
from dataclasses import dataclass
from datetime import date, timedelta

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError

Times = Float[np.ndarray, "*#batch"] | float
"""Seconds since an epoch, or another number per instant."""

DAY_S = 86_400.0
_MJD_ORDINAL = date(1858, 11, 17).toordinal()
_J2000_MJD = 51544.5  # 2000-01-01T12:00:00
_ISO = re.compile(
    r"(?P<year>\d{4})-(?:(?P<month>\d\d)-(?P<day>\d\d)|(?P<doy>\d{3}))"
    r"(?:[T ](?P<hour>\d\d):(?P<minute>\d\d)(?::(?P<second>\d\d(?:\.\d*)?))?)?"
    r"\s*(?P<zone>Z|UTC|[+-]\d\d:?\d\d)?",
    re.IGNORECASE,
)


@dataclass(frozen=True, slots=True, order=True)
class Instant:
    """A point in UTC."""

    mjd: int
    """Modified Julian day number, from midnight."""
    second: float
    """Second of that day, in [0, 86400)."""

    def __sub__(self, other: "Instant") -> float:
        """Seconds from `other` to this instant."""
        return (self.mjd - other.mjd) * DAY_S + (self.second - other.second)

    def plus(self, dt: float) -> "Instant":
        """The instant `dt` seconds later."""
        days, second = divmod(self.second + dt, DAY_S)
        return Instant(self.mjd + int(days), second)

    def iso(self, digits: int = 6) -> str:
        """ISO 8601 text, rounded to `digits` decimals of a second, trailing zeros dropped.

        >>> parse_iso("2024-11-01").plus(0.25).iso()
        '2024-11-01T00:00:00.25Z'
        """
        ticks = round(self.second * 10**digits)
        days, ticks = divmod(ticks, 86_400 * 10**digits)
        whole, part = divmod(ticks, 10**digits)
        day = date.fromordinal(_MJD_ORDINAL + self.mjd + days)
        fraction = f".{part:0{digits}d}".rstrip("0").rstrip(".") if digits else ""
        return f"{day.isoformat()}T{whole // 3600:02d}:{whole // 60 % 60:02d}:{whole % 60:02d}{fraction}Z"


def instant(year: int, month: int, day: int, second_of_day: float = 0.0) -> Instant:
    """The instant of a calendar date; raises ValueError on a date that does not exist."""
    return Instant(date(year, month, day).toordinal() - _MJD_ORDINAL, 0.0).plus(second_of_day)


def parse_iso(text: str) -> Instant:
    """ISO 8601 text as an instant: calendar or day-of-year dates, UTC unless an offset says otherwise.

    >>> parse_iso("2024-11-01T00:00:00Z") - parse_iso("2024-10-31T23:59:59.5")
    0.5
    """
    match = _ISO.fullmatch(text.strip())
    if match is None:
        raise InputError(f"epoch '{text}' is not ISO 8601 UTC; write it like 2024-11-01T00:00:00Z")
    try:
        return _from_fields(match)
    except (ValueError, OverflowError) as error:
        raise InputError(f"epoch '{text}' does not exist ({error}); write it like 2024-11-01T00:00:00Z") from None


def clock_seconds(hour: int, minute: int, second: float) -> float:
    """Second of the day of a clock reading; 60 is allowed for a leap second. ValueError on any other overflow."""
    if not (0 <= hour <= 24 and 0 <= minute < 60 and 0.0 <= second < 61.0):
        raise ValueError(f"{hour:02d}:{minute:02d}:{second:g} is not a time of day")
    return hour * 3600.0 + minute * 60.0 + second


def days_since_j2000(epoch_utc: str, t: Times) -> Times:
    """Days from 2000-01-01T12:00:00 UTC to `t` seconds after the epoch."""
    epoch = parse_iso(epoch_utc)
    return (epoch.mjd - _J2000_MJD) + (epoch.second + t) / DAY_S


def julian_date(epoch_utc: str, t: Times) -> Times:
    """Julian date (UTC) of `t` seconds after the epoch, to 40 microseconds."""
    return 2451545.0 + days_since_j2000(epoch_utc, t)


def _from_fields(match: re.Match[str]) -> Instant:
    year = int(match["year"])
    if match["doy"]:
        day = date(year, 1, 1) + timedelta(days=int(match["doy"]) - 1)
        if day.year != year:
            raise ValueError(f"day {match['doy']} of {year}")
    else:
        day = date(year, int(match["month"]), int(match["day"]))
    second = clock_seconds(int(match["hour"] or 0), int(match["minute"] or 0), float(match["second"] or 0.0))
    return instant(day.year, day.month, day.day, second - _zone_seconds(match["zone"]))


def _zone_seconds(zone: str | None) -> float:
    if zone is None or zone.upper() in ("Z", "UTC"):
        return 0.0
    digits = zone[1:].replace(":", "")
    return float(f"{zone[0]}1") * clock_seconds(int(digits[:2]), int(digits[2:]), 0.0)
