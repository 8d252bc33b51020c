"""Interpolating polynomials through the nearest points, for many instants at once.

SciPy's KroghInterpolator does the same for one set of nodes; here each instant has its own window of nodes, and a loop
over a day of ephemeris takes seconds.
"""

import numpy as np
from jaxtyping import Float

Values = Float[np.ndarray, "n d"]


def polynomials(
    tn: Float[np.ndarray, "n_nodes"],
    yn: Float[np.ndarray, "n_nodes d"],
    slopes: Float[np.ndarray, "n_nodes d"] | None,
    t: Float[np.ndarray, "n"],
    nodes: int,
) -> tuple[Values, Values]:
    """Values and derivatives at `t` through the nearest `nodes` points (Lagrange) and their slopes (Hermite)."""
    size = min(nodes, len(tn))
    start = np.clip(np.searchsorted(tn, t) - size // 2, 0, len(tn) - size)
    window = start[:, None] + np.arange(size)
    centre = tn[start + size // 2]
    scale = np.maximum(tn[start + size - 1] - tn[start], 1e-9)  # keeps powers of time near one
    x, y = (tn[window] - centre[:, None]) / scale[:, None], yn[window]
    dy = None if slopes is None else slopes[window] * scale[:, None, None]
    value, slope = _newton(x, y, dy, (t - centre) / scale)
    return value, slope / scale[:, None]


def _newton(
    x: Float[np.ndarray, "n m"],
    y: Float[np.ndarray, "n m d"],
    dy: Float[np.ndarray, "n m d"] | None,
    at: Float[np.ndarray, "n"],
) -> tuple[Values, Values]:
    """Divided differences over the nodes x, repeated where slopes are given, and Horner's scheme at `at`."""
    if dy is not None:
        x, y = np.repeat(x, 2, axis=1), np.repeat(y, 2, axis=1)
    table, coefficients = y, [y[:, 0]]
    for k in range(1, x.shape[1]):
        gap = x[:, k:] - x[:, :-k]
        repeated = gap == 0.0
        table = np.diff(table, axis=1) / np.where(repeated, 1.0, gap)[..., None]
        if dy is not None and k == 1:
            table[:, ::2] = dy
        coefficients.append(table[:, 0])
    value, slope = coefficients[-1], np.zeros_like(coefficients[-1])
    for k in range(x.shape[1] - 2, -1, -1):
        step = (at - x[:, k])[:, None]
        slope = slope * step + value
        value = value * step + coefficients[k]
    return value, slope
