"""Clocks of other systems in UTC."""

import pytest

from proxnav.errors import InputError
from proxnav.geometry.epochs import instant, parse_iso
from proxnav.trajectories.time_systems import time_system, to_utc, tt_from_utc

NOON = parse_iso("2024-11-01T12:00:00Z")


@pytest.mark.parametrize(("system", "ahead_s"), [("UTC", 0.0), ("TAI", 37.0), ("GPS", 18.0), ("TT", 69.184)])
def test_a_clock_is_ahead_of_utc_by_the_published_seconds(system, ahead_s):
    assert to_utc(NOON.plus(ahead_s), system) - NOON == pytest.approx(0.0, abs=1e-9)


def test_tdb_swings_about_terrestrial_time_by_1_7_milliseconds_a_year():
    swings = [
        to_utc(NOON.plus(day * 86400.0), "TT") - to_utc(NOON.plus(day * 86400.0), "TDB") for day in range(0, 365, 5)
    ]
    assert max(swings) == pytest.approx(1.7e-3, abs=1e-4)
    assert min(swings) == pytest.approx(-1.7e-3, abs=1e-4)


def test_a_second_that_was_inserted_is_counted_from_then_on():
    before, after = instant(2016, 12, 31, 86399.0), instant(2017, 1, 1, 1.0)
    assert to_utc(before.plus(36.0), "TAI") == before
    assert to_utc(after.plus(37.0), "TAI") == after
    assert tt_from_utc(before) - before == pytest.approx(36.0 + 32.184)
    assert tt_from_utc(after) - after == pytest.approx(37.0 + 32.184)


def test_other_names_are_none_and_times_before_whole_seconds_are_refused():
    assert [time_system(name) for name in ("gps", " tai ", "UT1", "MET")] == ["GPS", "TAI", None, None]
    with pytest.raises(InputError, match="from 1972 on"):
        to_utc(instant(1971, 1, 1), "TAI")
