"""Charts as inline SVG: coloured by the page's style sheet, with the numbers of each mark as its hover title."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from jaxtyping import Float

_WIDTH, _HEIGHT = 640, 360
_LEFT, _RIGHT, _TOP, _BOTTOM = 70, 14, 16, 52  # margins round the plot


@dataclass(frozen=True, slots=True)
class Axis:
    """A scale: what it measures, from where to where."""

    label: str
    """quantity [unit]"""
    low: float
    high: float
    log: bool = False

    def share(self, value: float) -> float:
        """Place of a value, 0 at `low` and 1 at `high`; what lies outside sits on the edge."""
        low, high = np.log10([self.low, self.high]) if self.log else (self.low, self.high)
        if self.log:
            value = float(np.log10(max(value, 1e-300)))
        return float(np.clip((value - low) / (high - low), 0.0, 1.0))

    def ticks(self) -> list[float]:
        """Round values inside the scale."""
        if self.log:
            return [10.0**k for k in range(round(np.log10(self.low)), int(np.floor(np.log10(self.high) + 1e-9)) + 1)]
        step = _round_step((self.high - self.low) / 6.0)
        first = np.ceil(self.low / step - 1e-9)
        return [float(k * step) + 0.0 for k in np.arange(first, self.high / step + 1e-9)]


@dataclass(frozen=True, slots=True)
class Mark:
    """One point of a scatter chart."""

    x: float
    y: float
    title: str
    """What is shown when the pointer rests on it."""
    kind: str = "point"
    """Class in the style sheet: point, outlier or none (no value: drawn on the upper edge)."""


@dataclass(frozen=True, slots=True)
class Line:
    """A line through points."""

    points: Sequence[tuple[float, float]]
    kind: str = "line"
    """Class in the style sheet: line, bound or error."""


def linear_axis(label: str, values: Sequence[float | int], from_zero: bool = False) -> Axis:
    """A scale that holds all finite values, with a little room."""
    finite = [value for value in values if np.isfinite(value)] or [0.0, 1.0]
    low, high = (0.0 if from_zero else min(finite)), max(finite)
    room = 0.04 * (high - low) or 0.5 * abs(high) or 1.0
    return Axis(label, low if from_zero else low - room, high + room)


def log_axis(label: str, values: Sequence[float], at_most: float = np.inf) -> Axis:
    """Whole decades that hold all positive values, cut at the largest value that can occur."""
    positive = [value for value in values if np.isfinite(value) and value > 0.0] or [0.1, 1.0]
    low, high = np.floor(np.log10(min(positive))), np.ceil(np.log10(max(positive)))
    return Axis(label, 10.0**low, min(10.0 ** max(high, low + 1.0), at_most), log=True)


def scatter(name: str, x: Axis, y: Axis, marks: Sequence[Mark], lines: Sequence[Line] = ()) -> str:
    """Marks over a grid, and lines. `name` says what the chart shows, for those who do not see it."""
    shapes = [_shape(mark, x, y) for mark in marks]
    return _svg(name, x, y, "".join([*shapes, *(_path(x, y, line.points, line.kind) for line in lines)]))


def band_chart(
    name: str,
    x: Axis,
    y: Axis,
    places: Float[np.ndarray, "n"],
    low: Float[np.ndarray, "n"],
    high: Float[np.ndarray, "n"],
    line: Line,
) -> str:
    """A line over the area between `low` and `high`."""
    there = [(float(a), float(b)) for a, b in zip(places, low, strict=True)]
    back = [(float(a), float(b)) for a, b in zip(places[::-1], high[::-1], strict=True)]
    zero = [(x.low, 0.0), (x.high, 0.0)]
    inside = [_path(x, y, there + back, "band"), _path(x, y, zero, "frame"), _path(x, y, line.points, line.kind)]
    return _svg(name, x, y, "".join(inside))  # fmt: skip


def histogram(
    name: str,
    x: Axis,
    edges: Float[np.ndarray, "n_edges"],
    counts: Float[np.ndarray, "n_bins"],
    y_label: str,
    line: Sequence[tuple[float, float]],
) -> str:
    """Bars over a grid and a reference curve."""
    y = linear_axis(y_label, [*counts, *(value for _, value in line)], from_zero=True)
    bars = []
    for left, right, count in zip(edges[:-1], edges[1:], counts, strict=True):
        x0, x1, top = _x(x, left), _x(x, right), _y(y, count)
        box = f'x="{x0:.1f}" y="{top:.1f}" width="{max(x1 - x0 - 1.0, 0.5):.1f}" height="{_y(y, 0.0) - top:.1f}"'
        bars.append(f'<rect class="bar" {box}><title>{left:.3g} to {right:.3g}: {count:.4g}</title></rect>')
    return _svg(name, x, y, "".join([*bars, _path(x, y, line, "line")]))


def running_median(x: Sequence[float], y: Sequence[float]) -> list[tuple[float, float]]:
    """Median of y over neighbours in x; empty below 20 points, where it would say nothing."""
    if len(x) < 20:
        return []
    order = np.argsort(np.asarray(x), kind="stable")
    window = max(5, len(order) // 15)
    windows = np.lib.stride_tricks.sliding_window_view
    xs, ys = windows(np.asarray(x)[order], window), windows(np.asarray(y)[order], window)
    step = max(1, window // 3)
    pairs = zip(np.median(xs, axis=1)[::step], np.median(ys, axis=1)[::step], strict=True)
    return [(float(a), float(b)) for a, b in pairs]


def _round_step(rough: float) -> float:
    power = 10.0 ** np.floor(np.log10(rough))
    return float(next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= rough * (1.0 - 1e-9)))


def _x(axis: Axis, value: float) -> float:
    return _LEFT + axis.share(value) * (_WIDTH - _LEFT - _RIGHT)


def _y(axis: Axis, value: float) -> float:
    return _HEIGHT - _BOTTOM - axis.share(value) * (_HEIGHT - _TOP - _BOTTOM)


def _shape(mark: Mark, x: Axis, y: Axis) -> str:
    u, title = _x(x, mark.x), f"<title>{escape(mark.title)}</title>"
    if mark.kind == "none":
        return f'<path class="none" d="M{u - 4:.1f},{_TOP - 4}l8,8m0,-8l-8,8">{title}</path>'
    v = _y(y, mark.y)
    if mark.kind == "outlier":
        return f'<path class="outlier" d="M{u:.1f},{v - 5:.1f}l5,9h-10z">{title}</path>'
    return f'<circle class="point" cx="{u:.1f}" cy="{v:.1f}" r="3.5">{title}</circle>'


def _path(x: Axis, y: Axis, points: Sequence[tuple[float, float]], kind: str) -> str:
    if not points:
        return ""
    return f'<path class="{kind}" d="M' + "L".join(f"{_x(x, a):.1f},{_y(y, b):.1f}" for a, b in points) + '"/>'


def _svg(name: str, x: Axis, y: Axis, inside: str) -> str:
    return f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="{escape(name)}">{_grid(x, y)}{inside}</svg>'


def _tick(value: float) -> str:
    """Short enough not to run into the axis' label."""
    text = f"{value:g}"
    return text if len(text) < 6 else f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e")


def _grid(x: Axis, y: Axis) -> str:
    right, bottom, middle = _WIDTH - _RIGHT, _HEIGHT - _BOTTOM, (_TOP + _HEIGHT - _BOTTOM) / 2
    parts = []
    for tick in x.ticks():
        u = _x(x, tick)
        parts.append(f'<path class="grid" d="M{u:.1f},{_TOP}V{bottom}"/>')
        parts.append(f'<text class="tick" x="{u:.1f}" y="{bottom + 18}" text-anchor="middle">{_tick(tick)}</text>')
    for tick in y.ticks():
        v = _y(y, tick)
        parts.append(f'<path class="grid" d="M{_LEFT},{v:.1f}H{right}"/>')
        parts.append(f'<text class="tick" x="{_LEFT - 8}" y="{v + 4:.1f}" text-anchor="end">{_tick(tick)}</text>')
    parts.append(f'<path class="frame" d="M{_LEFT},{_TOP}V{bottom}H{right}"/>')
    centre = (_LEFT + right) / 2
    parts.append(f'<text class="axis" x="{centre}" y="{_HEIGHT - 10}" text-anchor="middle">{escape(x.label)}</text>')
    turned = f'x="18" y="{middle}" text-anchor="middle" transform="rotate(-90 18 {middle})"'
    parts.append(f'<text class="axis" {turned}>{escape(y.label)}</text>')
    return "".join(parts)
