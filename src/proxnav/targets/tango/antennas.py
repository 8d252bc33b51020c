"""The three tapered rod antennas with their mounts, the two whips and the tube."""

import numpy as np

from proxnav.targets.solids import Piece, aim, box, revolve, rod
from proxnav.targets.tango.params import (
    ANTENNA_ROOTS_M,
    ANTENNA_TIPS_M,
    TUBE_M,
    WHIP_ROOTS_M,
    WHIP_TIPS_M,
    Point,
    TangoParams,
)

_WHIP_RADIUS_M, _TUBE_RADIUS_M = 0.0025, 0.0105


def antennas(p: TangoParams) -> list[Piece]:
    """All rods that stand out of the craft."""
    pieces = [
        piece for root, tip in zip(ANTENNA_ROOTS_M, ANTENNA_TIPS_M, strict=True) for piece in _antenna(p, root, tip)
    ]
    for root, tip in zip(WHIP_ROOTS_M, WHIP_TIPS_M, strict=True):
        foot = (np.sign(root[0]) * p.half_length_m, root[1], root[2])
        pieces += [rod("whip_feet", foot, root, 0.011), rod("whips", root, tip, _WHIP_RADIUS_M)]
    pieces.append(rod("tube", *TUBE_M, _TUBE_RADIUS_M))
    x = -p.half_length_m
    pieces += [box("tube_clamps", (TUBE_M[0][0], 0.207, z), (x, 0.251, z + 0.012)) for z in (0.045, 0.175)]
    return pieces


def _antenna(p: TangoParams, root: Point, tip: Point) -> list[Piece]:
    """A tapered rod with a rounded end, the ring that holds it, and the short piece of it behind the ring."""
    start, along = np.array(root), np.subtract(tip, root)
    length, axis = float(np.linalg.norm(along)), (float(along[0]), float(along[1]), float(along[2]))
    outer, inner, back = p.antenna_tip_radius_m, p.antenna_root_radius_m, -0.045
    tip_round = [(length, 0.0), (length - 0.001, 0.6 * outer), (length - 0.005, outer)]
    taper = [*tip_round, (0.0, inner), (back, inner), (back, 0.0)]
    collar = [(0.004, 0.0), (0.004, inner + 0.009), (-0.004, inner + 0.009), (-0.004, 0.0)]
    origin = (float(start[0]), float(start[1]), float(start[2]))
    return [aim(revolve("antennas", taper, 24), origin, axis), aim(revolve("antenna_rings", collar, 24), origin, axis)]
