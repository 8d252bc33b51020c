"""The filter's part of the report: errors inside their claimed 3 sigma along the solution."""

import math
from typing import Any

import numpy as np
from jaxtyping import Float
from markupsafe import Markup
from scipy.stats import norm

from proxnav.evaluation.solution_files import Solution
from proxnav.viewing.charts import Axis, Line, band_chart, linear_axis
from proxnav.viewing.number_text import number

_NAMES = ("radial", "in-track", "cross-track", "about target x", "about target y", "about target z")
_POINTS = 500  # of a line; more than a chart has pixels for
Series = Float[np.ndarray, "n"]


def filter_section(solution: Solution | None) -> dict[str, Any] | None:
    """Charts and table of a navigation solution; None where the run has none or nothing to compare it with."""
    if solution is None or not solution.has_truth:
        return None
    scale = np.array([1.0] * 3 + [180.0 / math.pi] * 3)
    errors, sigmas = solution.errors * scale, solution.sigma * scale
    return {
        "charts": [Markup(_chart(solution.t, errors[:, k], sigmas[:, k], k)) for k in range(6)],
        "rows": [_row(errors[:, k], sigmas[:, k], k) for k in range(6)],
        "honest": f"{100.0 * (2.0 * norm.cdf(3.0) - 1.0):.1f} %",
        "mean_nees": number(float(np.nanmean(solution.nees))) if np.isfinite(solution.nees).any() else "–",
        "instants": len(solution.t),
        "statuses": ", ".join(f"{solution.status.count(name)} {name}" for name in sorted(set(solution.status))),
    }


def _chart(t: Series, errors: Series, sigmas: Series, k: int) -> str:
    unit = "m" if k < 3 else "deg"
    keep = np.unique(np.linspace(0, len(t) - 1, min(_POINTS, len(t))).round().astype(int))
    keep = keep[np.isfinite(errors[keep])]
    bound = 3.0 * sigmas[keep]
    settled = bound[len(bound) // 10 :] if len(bound) > 20 else bound  # the start's wide bounds would flatten the rest
    top = 1.1 * float(max(settled.max(initial=0.0), np.abs(errors[keep]).max(initial=0.0))) or 1.0
    y = Axis(f"{_NAMES[k]} [{unit}]", -top, top)
    points = [(float(a), float(b)) for a, b in zip(t[keep], errors[keep], strict=True)]
    x = linear_axis("time [s]", [float(t[0]), float(t[-1])])
    name = f"Error {_NAMES[k]} [{unit}] along the flight, with the claimed 3 sigma on either side"
    return band_chart(name, x, y, t[keep], -bound, bound, Line(points, "error"))


def _row(errors: Series, sigmas: Series, k: int) -> dict[str, str]:
    known = np.isfinite(errors)
    inside = np.abs(errors[known]) <= 3.0 * sigmas[known]
    return {
        "name": f"{_NAMES[k]} [{'m' if k < 3 else 'deg'}]",
        "rms": number(float(np.sqrt(np.mean(errors[known] ** 2)))),
        "largest": number(float(np.abs(errors[known]).max())),
        "sigma": number(float(np.median(sigmas[known]))),
        "inside": f"{100.0 * inside.mean():.1f} %",
    }
