"""Dates as the tools write them, in English whatever the locale: UTCG, UTCJ, ISO-YMD, MATLAB, JDate, MJD, durations."""

import re

from proxnav.errors import InputError
from proxnav.geometry.epochs import DAY_S, Instant, clock_seconds, instant, parse_iso

_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
_CLOCK = r"(?P<hour>\d{1,2}):(?P<minute>\d{2})(?::(?P<second>\d{2}(?:[.,]\d*)?))?"
_GREGORIAN = re.compile(rf"(?P<day>\d{{1,2}})[ -](?P<month>[A-Za-z]{{3,9}})\.?[ -](?P<year>\d{{4}})(?:\s+{_CLOCK})?")
_ISO_YMD = re.compile(rf"(?P<year>\d{{4}})[/-](?P<month>\d{{1,2}})[/-](?P<day>\d{{1,2}})[T ]+{_CLOCK}Z?")
_EUROPEAN = re.compile(rf"(?P<day>\d{{1,2}})\.(?P<month>\d{{1,2}})\.(?P<year>\d{{4}})(?:[T ]+{_CLOCK})?")
_DAY_OF_YEAR = re.compile(rf"(?P<doy>\d{{1,3}})/(?P<year>\d{{4}}|\d{{2}})\s+{_CLOCK}")
_DURATION = re.compile(r"(?:(?P<days>\d+):)?(?P<hour>\d+):(?P<minute>\d{2}):(?P<second>\d{2}(?:\.\d*)?)")
_AMOUNT = re.compile(r"(?P<value>[-+0-9.eE]+)\s*(?P<unit>[a-z]+)")
_SECONDS = {"s": 1.0, "sec": 1.0, "secs": 1.0, "seconds": 1.0, "min": 60.0, "mins": 60.0, "minutes": 60.0}
_SECONDS |= {"h": 3600.0, "hr": 3600.0, "hrs": 3600.0, "hours": 3600.0, "d": DAY_S, "day": DAY_S, "days": DAY_S}
_GMAT_MJD_OFFSET = 2430000.0 - 2400000.5  # GMAT counts from JD 2430000.0, noon


def parse_date(text: str) -> Instant:
    """The instant that a date names.

    >>> parse_date("1 July 1999 00:00:00.00") == parse_date("1999-07-01T00:00:00Z")
    True
    >>> parse_date("01-Nov-2024 00:00:00").iso()
    '2024-11-01T00:00:00Z'
    """
    plain = text.strip().strip("\"'").strip()
    try:
        for pattern in (_GREGORIAN, _ISO_YMD, _EUROPEAN, _DAY_OF_YEAR):
            if match := pattern.fullmatch(plain):
                return _from_match(match.groupdict())
    except ValueError as error:
        raise InputError(f"date '{plain}' does not exist ({error})") from None
    return parse_iso(plain)


def from_julian_date(value: float) -> Instant:
    """The instant of a Julian date, to 40 microseconds."""
    return Instant(0, 0.0).plus((value - 2400000.5) * DAY_S)


def from_gmat_mjd(value: float) -> Instant:
    """The instant of GMAT's modified Julian date, which counts from JD 2430000.0."""
    return Instant(0, 0.0).plus((value + _GMAT_MJD_OFFSET) * DAY_S)


def parse_duration(text: str) -> float | None:
    """Seconds of a MATLAB duration such as 00:00:05 or '5 sec'; None where the text is none."""
    plain = text.strip().strip("\"'").strip().lower()
    if match := _DURATION.fullmatch(plain):
        days = int(match["days"] or 0)
        return days * DAY_S + int(match["hour"]) * 3600.0 + int(match["minute"]) * 60.0 + float(match["second"])
    match = _AMOUNT.fullmatch(plain)
    if match is None or match["unit"] not in _SECONDS:
        return None
    try:
        return float(match["value"]) * _SECONDS[match["unit"]]
    except ValueError:
        return None


def _from_match(found: dict[str, str | None]) -> Instant:
    year = int(found["year"] or 0)
    year += 0 if year > 99 else 2000 if year < 57 else 1900
    seconds = clock_seconds(
        int(found["hour"] or 0), int(found["minute"] or 0), float((found["second"] or "0").replace(",", "."))
    )
    if doy := found.get("doy"):
        if not 1 <= int(doy) <= 366:
            raise ValueError(f"day {doy} of a year")
        return instant(year, 1, 1, seconds).plus((int(doy) - 1) * DAY_S)
    return instant(year, _month(found["month"] or ""), int(found["day"] or 0), seconds)


def _month(text: str) -> int:
    if text.isdigit():
        return int(text)
    if text[:3].lower() not in _MONTHS:
        raise ValueError(f"'{text}' is no English month")
    return _MONTHS.index(text[:3].lower()) + 1
