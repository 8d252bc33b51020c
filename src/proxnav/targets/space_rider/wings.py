"""The solar wings: cell side up (zenith), bare back down."""

import numpy as np

from proxnav.targets.solids import Piece, box, rod
from proxnav.targets.space_rider.params import SpaceRiderParams

GAP_M = 0.03
"""Between the panels of a wing."""


def wings(p: SpaceRiderParams) -> list[Piece]:
    """Both wings with yokes and drive units."""
    return [piece for side in (-1, 1) for piece in _wing(p, side)]


def wing_axis_x_m(p: SpaceRiderParams) -> float:
    """Where the drive shafts cross the stack's axis."""
    return p.module_fore_x_m - p.wing_aft_m


def wing_corners_m(p: SpaceRiderParams, side: int) -> dict[str, tuple[float, float, float]]:
    """Corners of the left (-1) or right (+1) wing half-way through the panel: visible from both sides."""
    x, h, z = wing_axis_x_m(p), p.wing_chord_m / 2, -p.wing_raise_m
    root, tip = side * p.wing_root_m, side * p.wing_span_m / 2
    return {
        f"{name_y}_{name_x}": (x + dx, y, z)
        for name_y, y in (("inner", root), ("outer", tip))
        for name_x, dx in (("fore", h), ("aft", -h))
    }


def _wing(p: SpaceRiderParams, side: int) -> list[Piece]:
    x, h, z, t = wing_axis_x_m(p), p.wing_chord_m / 2, -p.wing_raise_m, p.wing_thickness_m / 2
    width = (p.wing_span_m / 2 - p.wing_root_m - GAP_M * (p.panels_per_wing - 1)) / p.panels_per_wing
    pieces: list[Piece] = []
    for i in range(p.panels_per_wing):
        start = p.wing_root_m + i * (width + GAP_M)
        y0, y1 = sorted((side * start, side * (start + width)))
        pieces += _panel((x - h, y0, z - t), (x + h, y1, z + t))
    hull = float(np.sqrt(max(p.module_radius_m**2 - p.wing_raise_m**2, 0.0)))
    joint, root = (x, side * (hull + 0.22), z), side * p.wing_root_m
    y0, y1 = sorted((side * (hull - 0.1), side * (hull + 0.22)))
    pieces.append(box("wing_drives", (x - 0.14, y0, z - 0.14), (x + 0.14, y1, z + 0.14)))
    pieces += [rod("wing_yokes", joint, (x + dx, root, z), 0.025) for dx in (-0.7 * h, 0.7 * h)]
    hinges = [p.wing_root_m + i * (width + GAP_M) - GAP_M / 2 for i in range(1, p.panels_per_wing)]
    for y in hinges:
        pieces += [
            rod("wing_yokes", (x + d, side * y - 0.04, z), (x + d, side * y + 0.04, z), 0.02) for d in (-h / 2, h / 2)
        ]
    return pieces


def _panel(low: tuple[float, float, float], high: tuple[float, float, float]) -> list[Piece]:
    """One panel; its top is cells, its bottom the back, its rim the frame."""
    whole = box("", low, high)
    z = whole.vertices_m[whole.faces][:, :, 2]
    top, bottom = np.ptp(z, axis=1) + z[:, 0] == low[2], np.ptp(z, axis=1) * -1 + z[:, 0] == high[2]
    flat = np.ptp(z, axis=1) == 0
    groups = {"wing_cells": flat & top, "wing_backs": flat & bottom, "wing_frames": ~flat}
    return [Piece(name, whole.vertices_m, whole.faces[mask]) for name, mask in groups.items()]
