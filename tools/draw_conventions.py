"""Draws docs/gallery/conventions-*.svg: the frames round a target, and where pixels begin; run it from the root."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

OUT = Path("docs/gallery")
INK, RED, GREEN, BLUE, QUIET = "#1a1f26", "#c62828", "#2e7d32", "#1565c0", "#6b7785"
GROUND = {"facecolor": "white", "edgecolor": "none", "pad": 0.8}
SAVE = {"format": "svg", "metadata": {"Date": None}}


def arrow(axes: Axes, start: tuple[float, float], step: tuple[float, float], colour: str, text: str) -> None:
    """An arrow with a label beyond its tip."""
    end = (start[0] + step[0], start[1] + step[1])
    axes.annotate(
        "", end, start, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 2, "shrinkA": 0, "shrinkB": 0}
    )
    x, y = np.array(step) / np.hypot(*step)
    ha = "left" if x > 0.5 else "right" if x < -0.5 else "center"
    axes.text(end[0] + 0.15 * x, end[1] + 0.3 * y, text, color=colour, ha=ha, va="center", fontsize=10, bbox=GROUND)


def bare(figure: Figure, place: int, title: str, x: tuple[float, float], y: tuple[float, float]) -> Axes:
    """A drawing plane without axes."""
    axes = figure.add_subplot(1, 2, place, aspect="equal", xlim=x, ylim=y, title=title)
    axes.set_axis_off()
    return axes


def frames() -> Figure:
    """Left: RIC and target frame on the orbit. Right: what T_cam_target does."""
    figure = Figure(figsize=(10.0, 4.4), layout="constrained")
    orbit = bare(figure, 1, "ric and target, seen along the orbit's normal", (-5.6, 6.6), (-1.6, 5.4))
    turn = np.linspace(0.6, np.pi - 0.6, 60)
    orbit.plot(6 * np.cos(turn), 9 * np.sin(turn) - 7.2, color=QUIET, lw=1)
    orbit.plot(3 * np.cos(turn), 3 * np.sin(turn) - 3.9, color=QUIET, lw=1.5)
    orbit.text(0, -1.4, "Earth", color=QUIET, ha="center")
    arrow(orbit, (0, 1.8), (0, 2.2), RED, "x radial, out")
    arrow(orbit, (0, 1.8), (-2.6, 0), GREEN, "y in-track")
    orbit.plot([0], [1.8], "o", color=BLUE, ms=11, mfc="none", mew=2)
    orbit.plot([0], [1.8], "o", color=BLUE, ms=4)
    orbit.text(0.35, 1.25, "z orbit normal\n(towards you)", color=BLUE, fontsize=9, va="top")
    arrow(orbit, (3.6, 3.2), (-1.3, 0.0), RED, "x nose")
    arrow(orbit, (3.6, 3.2), (0.0, -1.2), BLUE, "z belly")
    orbit.text(2.4, 3.65, "target frame: x nose, z down,\ny right wing (away from you)", color=INK, fontsize=9)
    seen = bare(figure, 2, "p_cam = T_cam_target @ p_target", (-1.0, 11.0), (-3.6, 3.6))
    seen.fill([0, 1.1, 1.1], [0, 0.7, -0.7], color="#dfe6ee")
    arrow(seen, (0, 0), (2.4, 0), BLUE, "z forward")
    arrow(seen, (0, 0), (0, -2.0), GREEN, "y down")
    seen.plot([0], [0], "o", color=RED, ms=11, mfc="none", mew=2)
    seen.plot([0], [0], "o", color=RED, ms=4)
    seen.text(0, 0.75, "cam: x right\n(towards you)", color=RED, ha="center", fontsize=9)
    arrow(seen, (8.2, 0.6), (-1.5, 0.8), RED, "x")
    arrow(seen, (8.2, 0.6), (0.8, 1.5), BLUE, "z")
    seen.text(8.6, 0.1, "target", color=INK, fontsize=10)
    seen.annotate("", (8.1, 0.55), (0.05, 0.0), arrowprops={"arrowstyle": "-|>", "color": QUIET, "ls": "--"})
    seen.text(4.6, -0.35, "T_cam_target.t_m: the target's origin\nseen from the camera, in camera axes", color=QUIET,
              fontsize=9, ha="center", va="top")  # fmt: skip
    return figure


def pixels() -> Figure:
    """Corner origin against OpenCV's pixel-centre origin, in an image of 4 x 3 pixels."""
    figure = Figure(figsize=(9.0, 3.8), layout="constrained")
    for place, (title, shift) in enumerate((("proxnav: corner origin", 0.0), ("OpenCV: pixel-centre origin", 0.5)), 1):
        axes = bare(figure, place, title, (-0.9, 5.0), (3.7, -1.0))
        for k in range(5):
            axes.plot([k, k], [0, 3], color=QUIET, lw=1)
        for k in range(4):
            axes.plot([0, 4], [k, k], color=QUIET, lw=1)
        arrow(axes, (shift, shift), (4.4 - shift, 0), RED, "u")
        arrow(axes, (shift, shift), (0, 3.3 - shift), GREEN, "v")
        axes.plot([0.5], [0.5], "o", color=BLUE, ms=6)
        first = "(0.5, 0.5)" if shift == 0 else "(0, 0)"
        axes.text(0.65, 0.62, f"first pixel's centre:\n{first}", color=BLUE, fontsize=9, va="top", bbox=GROUND)
        axes.plot([2], [1.5], "+", color=INK, ms=11, mew=2)
        middle = "W/2, H/2 = 2, 1.5" if shift == 0 else "(W-1)/2, (H-1)/2 = 1.5, 1"
        axes.text(2.1, 1.75, f"middle of the image:\n{middle}", color=INK, fontsize=9, va="top", bbox=GROUND)
    return figure


if __name__ == "__main__":
    frames().savefig(OUT / "conventions-frames.svg", **SAVE)
    pixels().savefig(OUT / "conventions-pixels.svg", **SAVE)
