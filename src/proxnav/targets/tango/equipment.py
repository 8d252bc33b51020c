"""What is mounted on the plates and sides: each device is on one side only, so that the sides can be told apart."""

import numpy as np

from proxnav.targets.solids import Piece, aim, box, revolve, rod
from proxnav.targets.tango.params import ANTENNA_ROOTS_M, Point, TangoParams

RADIATOR_LOW_M: Point = (-0.081, 0.284, 0.020)
RADIATOR_HIGH_M: Point = (0.193, 0.327, 0.161)
"""Opposite corners of the box on the long side at +y."""
EDGE_UNIT_LOW_M: Point = (-0.046, 0.385, 0.303)
EDGE_UNIT_HIGH_M: Point = (-0.003, 0.457, 0.316)
"""Opposite corners of the wider of two plates at the panel's edge."""


def equipment(p: TangoParams) -> list[Piece]:
    """Radiator and boxes at +y, domes and a camera on the end plates, thruster rail and cut-outs at the bottom."""
    x, low = p.half_length_m, p.box_low_y_m
    pieces = [
        box("radiator", RADIATOR_LOW_M, RADIATOR_HIGH_M),
        box("side_unit", (-0.165, 0.280, 0.020), (-0.086, 0.300, 0.130)),
        box("edge_unit", EDGE_UNIT_LOW_M, EDGE_UNIT_HIGH_M),
        box("edge_unit", (-0.003, 0.385, 0.303), (0.075, 0.434, 0.316)),
        box("edge_unit", (-0.038, 0.385, 0.280), (0.080, 0.391, 0.303)),
        box("bottom_unit", (-0.020, 0.272, -0.027), (0.022, p.box_high_y_m + 0.012, 0.0)),
        box("end_camera", (x, 0.122, 0.268), (x + 0.030, 0.162, 0.322)),
        rod("thruster_rail", (-0.335, low - 0.004, -0.004), (-0.145, low - 0.004, -0.004), 0.007),
    ]
    pieces += [rod("thruster_rail", (t, low - 0.018, -0.010), (t, low + 0.024, -0.010), 0.007) for t in _RAIL_M]
    pieces += [rod("side_unit", (-0.125, 0.295, z), (-0.125, 0.330, z), 0.004) for z in (0.05, 0.07, 0.09, 0.11)]
    return [*pieces, *_domes(p), *_cut_outs(), *_antenna_mounts(p)]


_RAIL_M = (-0.326, -0.282, -0.240, -0.198, -0.154)
_CUT_OUTS_M = ((0.0, -0.205), (-0.215, 0.163), (0.215, 0.163))


def _domes(p: TangoParams) -> list[Piece]:
    """A dome on each end plate, the one at +x higher."""
    return [
        aim(_dome(rise), (side * p.half_length_m, -0.078, 0.247), (side, 0.0, 0.0))
        for side, rise in ((-1.0, 0.018), (1.0, 0.036))
    ]


def _dome(rise_m: float, radius_m: float = 0.045) -> Piece:
    arc = [(rise_m * float(np.cos(t)), radius_m * float(np.sin(t))) for t in np.linspace(0.0, np.pi / 2, 7)]
    return revolve("domes", [*arc, (-0.004, radius_m), (-0.004, 0.0)], 28)


def _cut_outs() -> list[Piece]:
    """Dark round openings in the bottom plate, drawn as shallow discs with a nozzle in their middle."""
    disc = revolve("cut_outs", [(0.0015, 0.0), (0.0015, 0.037), (-0.002, 0.037), (-0.002, 0.0)], 20)
    nozzle = revolve("nozzles", [(0.010, 0.0), (0.010, 0.013), (0.0, 0.010), (0.0, 0.0)], 12)
    return [aim(piece, (x, y, 0.0), (0.0, 0.0, -1.0)) for x, y in _CUT_OUTS_M for piece in (disc, nozzle)]


def _antenna_mounts(p: TangoParams) -> list[Piece]:
    """Boxes in foil between the box's sides and the antennas' rings."""
    pieces: list[Piece] = []
    for x, y, z in ANTENNA_ROOTS_M:
        inner = p.box_low_y_m if y < 0 else p.box_high_y_m
        near, far = sorted((inner, y - np.sign(y) * 0.014))
        middle = np.sign(x) * min(abs(x), p.half_length_m - 0.034)
        pieces.append(box("antenna_mounts", (middle - 0.032, near, z - 0.036), (middle + 0.032, far, p.panel_bottom_m)))
    return pieces
