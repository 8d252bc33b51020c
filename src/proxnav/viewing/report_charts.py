"""Charts of single-image estimates for the report: errors against range and phase angle, honesty of the covariances."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from jaxtyping import Float
from markupsafe import Markup
from scipy.stats import chi2, norm

from proxnav.evaluation.pairing import PairedFrame
from proxnav.evaluation.run_folder import Run
from proxnav.geometry.pose_errors import HALF_TURN_RAD
from proxnav.viewing.charts import Line, Mark, histogram, linear_axis, log_axis, running_median, scatter
from proxnav.viewing.number_text import number

_AXES = ("x right [m]", "y down [m]", "z forward [m]", "about x [rad]", "about y [rad]", "about z [rad]")
_DEG = 180.0 / math.pi


def range_charts(run: Run) -> Iterator[str]:
    """E_T and E_R against the true range, with the Cramer-Rao bound where the run knows it."""
    x = linear_axis("true range [m]", [frame.range_m for frame in run.frames])
    for kind, label, scale, at_most in _KINDS[:2]:
        values = [_value(frame, kind) * scale for frame in run.frames]
        bounds = [(frame.range_m, _bound(frame, run, kind) * scale) for frame in run.frames]
        yield _chart(run, x, label, [frame.range_m for frame in run.frames], values, at_most, bounds)


def phase_charts(run: Run) -> Iterator[str]:
    """E_TN and E_R against the angle Sun, target, camera; nothing where the run does not know the Sun."""
    angles = [math.degrees(run.notes[f.filename].phase_rad) if f.filename in run.notes else np.nan for f in run.frames]
    if not np.isfinite(angles).any():
        return
    x = linear_axis("phase angle Sun, target, camera [deg]", angles)
    for kind, label, scale, at_most in (_KINDS[2], _KINDS[1]):
        values = [_value(frame, kind) * scale for frame in run.frames]
        yield _chart(run, x, label, angles, values, at_most, [])


_KINDS = (
    ("e_t_norm_m", "position error E_T [m]", 1.0, math.inf),
    ("e_r_rad", "attitude error E_R [deg]", _DEG, 180.0),
    ("e_tn", "position error over range E_TN [-]", 1.0, math.inf),
)


def _chart(
    run: Run,
    x: Any,
    label: str,
    places: list[float],
    values: list[float],
    at_most: float,
    bounds: list[tuple[float, float]],
) -> str:
    marks, unit = [], x.label.split()[-1].strip("[]")
    for frame, place, value in zip(run.frames, places, values, strict=True):
        if not math.isfinite(place):
            continue
        if frame.errors is None:
            marks.append(Mark(place, 0.0, f"{frame.filename}: {frame.status} at {place:.1f} {unit}", "none"))
        else:
            kind = "outlier" if frame.errors.e_r_rad > HALF_TURN_RAD else "point"
            marks.append(Mark(place, value, f"{frame.filename}: {value:.4g} at {place:.1f} {unit}", kind))
    posed = [(p, v) for p, v in zip(places, values, strict=True) if math.isfinite(p) and math.isfinite(v)]
    known = [(p, b) for p, b in bounds if math.isfinite(b)]
    lines = [Line(running_median(*_columns(posed)), "line"), Line(running_median(*_columns(known)), "bound")]
    name = f"{label} against {x.label}, {len(posed)} poses"
    every = [value for _, value in posed] + [bound for _, bound in lines[1].points]
    return scatter(name, x, log_axis(label, every, at_most), marks, lines)  # fmt: skip


def stanford_charts(run: Run) -> Iterator[str]:
    """Errors against protection levels, position and attitude; nothing where the run's poses have no levels.

    Of each pose the axis that comes nearest to its level is shown.
    """
    frames = [frame for frame in run.frames if np.isfinite(frame.protection).all()]
    if not frames:
        return
    for axes, scale, unit in ((slice(0, 3), 1.0, "m"), (slice(3, 6), _DEG, "deg")):
        pairs = [_nearest(np.abs(f.difference[axes]) * scale, f.protection[axes] * scale) for f in frames]
        every = [value for pair in pairs for value in pair]
        x, y = log_axis(f"error of the axis [{unit}]", every), log_axis(f"protection level [{unit}]", every)
        marks = [
            Mark(e, level, f"{f.filename}: {e:.3g} of {level:.3g} {unit}", "outlier" if e > level else "point")
            for f, (e, level) in zip(frames, pairs, strict=True)
        ]
        name = (
            f"Stanford diagram, {unit}: {sum(e > level for e, level in pairs)} of {len(pairs)} poses exceed their level"
        )
        yield scatter(name, x, y, marks, [Line([(x.low, x.low), (x.high, x.high)], "bound")])


def _nearest(errors: Float[np.ndarray, "3"], levels: Float[np.ndarray, "3"]) -> tuple[float, float]:
    """Error and level of the axis whose error is the largest share of its level."""
    k = int(np.argmax(errors / levels))
    return float(errors[k]), float(levels[k])


def _columns(pairs: list[tuple[float, float]]) -> tuple[list[float], list[float]]:
    return [a for a, _ in pairs], [b for _, b in pairs]


def _value(frame: PairedFrame, kind: str) -> float:
    return math.nan if frame.errors is None else float(getattr(frame.errors, kind))


def _bound(frame: PairedFrame, run: Run, kind: str) -> float:
    note = run.notes.get(frame.filename)
    if note is None:
        return math.nan
    return note.bound_e_t_m if kind == "e_t_norm_m" else note.bound_e_r_rad


def calibration(run: Run) -> dict[str, Any] | None:
    """Chart of normalised squared errors and the shares inside k sigma per axis; None without covariances."""
    frames = [frame for frame in run.frames if frame.T_est is not None and frame.covariance is not None]
    if not frames:
        return None
    normalised = np.abs(np.array([frame.normalised for frame in frames]))
    nees = np.array([frame.nees for frame in frames])
    inside = [
        (axis, [f"{100.0 * np.mean(normalised[:, k] <= n):.1f} %" for n in (1, 2, 3)]) for k, axis in enumerate(_AXES)
    ]
    return {
        "poses": len(frames),
        "mean": number(float(nees.mean())),
        "median": number(float(np.median(nees))),
        "honest_median": number(float(chi2.median(6))),
        "inside": inside,
        "honest": [f"{100.0 * (2.0 * norm.cdf(n) - 1.0):.1f} %" for n in (1, 2, 3)],
        "chart": Markup(_nees_chart(nees)),
    }


def _nees_chart(nees: Float[np.ndarray, "n"]) -> str:
    top = 24.0  # chi-square with 6 degrees of freedom leaves 0.05 % beyond
    edges = np.linspace(0.0, top, 17)
    counts = np.histogram(np.minimum(nees, top - 1e-9), edges)[0] / (len(nees) * np.diff(edges))
    places = np.linspace(0.0, top, 121)
    line = [(float(a), float(b)) for a, b in zip(places, chi2.pdf(places, 6), strict=True)]
    x = linear_axis(f"squared normalised error, 6 numbers [-]; last bar: all above {edges[-2]:g}", [0.0, top], True)
    name = (
        f"Histogram of the squared normalised errors of {len(nees)} poses against chi-square with 6 degrees of freedom"
    )
    return histogram(name, x, edges, counts, "density [-]", line)
