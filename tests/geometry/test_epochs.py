"""Instants: parsing, exact differences, round trips."""

import math
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxnav.errors import InputError
from proxnav.geometry.epochs import Instant, julian_date, parse_iso

DATES = st.datetimes(min_value=datetime(1900, 1, 1), max_value=datetime(2200, 1, 1))


@given(DATES)
def test_parsing_agrees_with_the_standard_library(moment):
    reference = datetime(2000, 1, 1)
    seconds = (moment - reference) / timedelta(seconds=1)
    assert parse_iso(moment.isoformat()) - parse_iso("2000-01-01") == pytest.approx(seconds, abs=1e-6)


@given(DATES)
def test_iso_text_round_trips(moment):
    instant = parse_iso(moment.isoformat())
    assert abs(parse_iso(instant.iso(9)) - instant) < 1e-9


def test_differences_stay_exact_over_decades():
    assert parse_iso("2024-11-01T00:00:00.125Z") - parse_iso("1970-01-01T00:00:00Z") == 1730419200.125


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("2024-11-01", "2024-11-01T00:00:00Z"),
        ("2024-306T12:00:00", "2024-11-01T12:00:00Z"),
        ("2024-11-01 02:00:00+02:00", "2024-11-01T00:00:00Z"),
        ("2024-10-31T18:30:00-0530", "2024-11-01T00:00:00Z"),
        ("2016-12-31T23:59:60Z", "2017-01-01T00:00:00Z"),
        ("2024-10-31T24:00", "2024-11-01T00:00:00Z"),
    ],
)
def test_spellings_of_one_instant_agree(text, same):
    assert parse_iso(text) == parse_iso(same)


@pytest.mark.parametrize(
    "text", ["", "now", "2024-13-01", "2023-02-29T00:00:00", "2023-366", "2024-11-01T25:00:00", "01-Nov-2024"]
)
def test_an_epoch_that_does_not_exist_is_one_sentence(text):
    with pytest.raises(InputError, match=r"epoch '.*' .*write it like 2024-11-01T00:00:00Z"):
        parse_iso(text)


def test_rounding_carries_into_the_next_day():
    assert Instant(60614, math.nextafter(86400.0, 0.0)).iso() == "2024-11-01T00:00:00Z"


def test_julian_date_of_the_unix_epoch():
    assert julian_date("1970-01-01T00:00:00Z", np.array([0.0, 43200.0])).tolist() == [2440587.5, 2440588.0]
    assert parse_iso("1970-01-01") == Instant(40587, 0.0)
    assert datetime(1970, 1, 1, tzinfo=UTC).timestamp() == 0.0
