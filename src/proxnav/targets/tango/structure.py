"""The box: bottom plate, end plates and long sides in foil; and the solar panel with its cells."""

import numpy as np

from proxnav.targets.solids import Piece, box
from proxnav.targets.tango.params import TangoParams

CELL_RISE_M = 0.0005
"""Cover glass above the panel: enough for a renderer to tell the two surfaces apart."""
_ROW_GAP_M, _COLUMN_GAP_M, _CROP_M = 0.0022, 0.0008, 0.012


def structure(p: TangoParams) -> list[Piece]:
    """Box and panel; every piece is closed, and neighbours touch."""
    x, low, high, top = p.half_length_m, p.box_low_y_m, p.box_high_y_m, p.panel_bottom_m
    inner, inset = x - p.plate_m, p.wall_inset_m
    return [
        box("bottom_plate", (-x, low, 0.0), (x, high, p.plate_m)),
        box("end_plate_back", (-x, low, p.plate_m), (-inner, high, top)),
        box("end_plate_front", (inner, low, p.plate_m), (x, high, top)),
        box("foil_sides", (-inner, low + inset, p.plate_m), (inner, high - inset, top)),
        box("panel", (-x, -p.panel_half_width_m, top), (x, p.panel_half_width_m, p.height_m)),
        *_cells(p),
    ]


def _cells(p: TangoParams) -> list[Piece]:
    """Two fields of cells; the cropped corners of both point to +y on the -x field and to -y on the other."""
    y0 = p.cells_y_m - 0.5 * p.cell_rows * p.cell_length_m
    pieces: list[Piece] = []
    for side in (-1, 1):
        edge = p.strip_x_m + side * p.strip_m / 2
        for column in range(p.cell_columns):
            x = edge + side * (column + 0.5) * p.cell_width_m
            for row in range(p.cell_rows):
                pieces.append(_cell(p, x, y0 + (row + 0.5) * p.cell_length_m, -side))
    return pieces


def _cell(p: TangoParams, x: float, y: float, cropped: int) -> Piece:
    """A flat prism with two of its four corners cropped, half sunk in the panel."""
    a, b = 0.5 * (p.cell_width_m - _COLUMN_GAP_M), 0.5 * (p.cell_length_m - _ROW_GAP_M)
    c = min(_CROP_M, 0.5 * b)
    outline = np.array([(-a, -b), (a, -b), (a, b - c), (a - c, b), (c - a, b), (-a, b - c)]) * [1.0, cropped]
    outline = outline[::cropped] + np.array([x, y])
    low, high = p.height_m - CELL_RISE_M, p.height_m + CELL_RISE_M
    n = len(outline)
    vertices = np.vstack([np.column_stack([outline, np.full(n, z)]) for z in (low, high)])
    ring = np.arange(n)
    after = (ring + 1) % n
    fan = np.array([(0, i, i + 1) for i in range(1, n - 1)])
    sides = [np.stack([ring, after, after + n], 1), np.stack([ring, after + n, ring + n], 1)]
    return Piece("cells", vertices, np.concatenate([fan[:, ::-1], fan + n, *sides]))
