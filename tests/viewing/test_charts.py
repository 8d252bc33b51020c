"""Charts place what they show where it belongs."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxnav.viewing.charts import Axis, Mark, histogram, linear_axis, log_axis, running_median, scatter

values = st.lists(st.floats(1e-6, 1e6), min_size=1, max_size=30)


@given(values)
def test_axes_hold_all_values_and_their_ticks(numbers: list[float]) -> None:
    for axis in (linear_axis("a [m]", numbers), log_axis("a [m]", numbers)):
        assert axis.low <= min(numbers) * (1 + 1e-9)
        assert axis.high >= max(numbers) * (1 - 1e-9)
        assert all(axis.low * (1 - 1e-9) <= tick <= axis.high * (1 + 1e-9) for tick in axis.ticks())
        assert len(axis.ticks()) >= 2


def test_a_log_axis_puts_each_decade_at_equal_distance() -> None:
    axis = Axis("a [m]", 0.01, 10.0, log=True)
    assert [axis.share(v) for v in (0.01, 0.1, 1.0, 10.0)] == pytest.approx([0, 1 / 3, 2 / 3, 1])
    assert axis.share(0.0) == 0.0  # an error of exactly zero sits on the lower edge


def test_a_limit_cuts_the_upper_decade() -> None:
    axis = log_axis("E_R [deg]", [0.2, 170.0], at_most=180.0)
    assert axis.high == 180.0
    assert axis.ticks() == pytest.approx([0.1, 1.0, 10.0, 100.0])


def test_marks_lie_where_their_numbers_say_and_carry_their_names() -> None:
    x, y = Axis("range [m]", 0.0, 100.0), Axis("E_T [m]", 0.01, 1.0, log=True)
    svg = ET.fromstring(scatter("chart", x, y, [Mark(50.0, 0.1, "a<b>.png")]))
    (circle,) = svg.iter("circle")
    assert float(circle.attrib["cx"]) == pytest.approx(70 + 0.5 * (640 - 70 - 14), abs=0.1)
    assert float(circle.attrib["cy"]) == pytest.approx(360 - 52 - 0.5 * (360 - 16 - 52), abs=0.1)
    assert circle[0].text == "a<b>.png"


def test_bars_have_the_height_of_their_counts() -> None:
    chart = histogram("h", linear_axis("v [-]", [0, 2], True), np.array([0.0, 1.0, 2.0]), np.array([1.0, 2.0]), "n", [])
    low, high = (float(bar.attrib["height"]) for bar in ET.fromstring(chart).iter("rect"))
    assert high == pytest.approx(2 * low, abs=0.2)


def test_running_median_follows_a_line_and_ignores_outliers(rng: np.random.Generator) -> None:
    x = rng.uniform(10, 100, 400)
    y = 0.01 * x
    y[::20] = 50.0
    line = np.array(running_median(list(x), list(y)))
    np.testing.assert_allclose(line[:, 1], 0.01 * line[:, 0], rtol=0.05)


def test_few_points_get_no_median_line() -> None:
    assert running_median([1.0] * 19, [1.0] * 19) == []
