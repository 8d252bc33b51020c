"""Figures of integrity: what is caught at which price, and errors against their protection levels."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.figure import Figure

_GOOD, _WRONG, _LINES = "#0b5cad", "#b3261e", ("#0b5cad", "#b45309", "#6b7280")


def roc(
    signals: Mapping[str, tuple[Float[np.ndarray, "n"], Bool[np.ndarray, "n"]]],
) -> Figure:
    """Share of hazardous poses that are caught against the share of good ones that is given up, for each signal.

    A signal is (doubt, whether the pose is hazardous); larger doubts are refused first.
    """
    figure = Figure(figsize=(6.0, 5.0), layout="constrained")
    axes = figure.subplots()
    for (name, (doubt, wrong)), colour in zip(signals.items(), _LINES, strict=False):
        order = np.argsort(-doubt, kind="stable")
        caught = np.r_[0.0, np.cumsum(wrong[order]) / max(wrong.sum(), 1)]
        lost = np.r_[0.0, np.cumsum(~wrong[order]) / max((~wrong).sum(), 1)]
        axes.step(lost, caught, where="post", color=colour, label=f"{name}, area {roc_area(doubt, wrong):.3f}")
    axes.set(xlabel="good poses given up", ylabel="hazardous poses caught", xlim=(0.0, 0.3), ylim=(0.0, 1.02))
    axes.grid(alpha=0.4)
    axes.legend(loc="lower right")
    return figure


def roc_area(doubt: Float[np.ndarray, "n"], wrong: Bool[np.ndarray, "n"]) -> float:
    """Probability that a hazardous pose is doubted more than a good one; ties count half."""
    bad, good = doubt[wrong], doubt[~wrong]
    if not bad.size or not good.size:
        return float("nan")
    return float(np.mean(np.sign(bad[:, None] - good[None]) * 0.5 + 0.5))


def stanford(
    errors: Float[np.ndarray, "n"], levels: Float[np.ndarray, "n"], wrong: Bool[np.ndarray, "n"], unit: str
) -> Figure:
    """Stanford diagram: error against protection level; a point below the diagonal is misleading."""
    figure = Figure(figsize=(5.5, 5.0), layout="constrained")
    axes = figure.subplots()
    both = np.concatenate([errors, levels]) if len(errors) else np.ones(1)
    low, high = 0.5 * max(float(both.min()), 1e-4), 2.0 * float(both.max())
    axes.fill_between([low, high], [low, low], [low, high], color=_WRONG, alpha=0.1, label="misleading")
    axes.plot(errors[~wrong], levels[~wrong], ".", color=_GOOD, alpha=0.6, label="accepted pose")
    axes.plot(errors[wrong], levels[wrong], "^", color=_WRONG, label="accepted, hazardous")
    axes.plot([low, high], [low, high], color="#6b7280", linewidth=1)
    axes.set(xscale="log", yscale="log", xlim=(low, high), ylim=(low, high))
    axes.set(xlabel=f"largest error of the axes [{unit}]", ylabel=f"protection level of that axis [{unit}]")
    axes.grid(alpha=0.4)
    axes.legend(loc="upper left")
    return figure
