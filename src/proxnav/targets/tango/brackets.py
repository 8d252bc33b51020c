"""Trusses of thin struts that hold the plates together and the panel's corners."""

from proxnav.targets.solids import Piece, rod
from proxnav.targets.tango.params import Point, TangoParams

_STRUT_M = 0.0045
"""Radius of a strut."""


def brackets(p: TangoParams) -> list[Piece]:
    """Trusses at the bottom's edges, at its corners and below the panel's corners."""
    return [*_middle(p), *_corners(p), *_panel_corners(p)]


def _middle(p: TangoParams) -> list[Piece]:
    """A W about the bottom edge of each end plate."""
    pieces: list[Piece] = []
    for side in (-1, 1):
        out, foot = side * (p.half_length_m + 0.010), side * (p.half_length_m - 0.058)
        face = side * (p.half_length_m + 0.004)
        top = [(out, y, -0.010) for y in (-0.022, 0.021, 0.065)]
        for feet in ([(foot, y, -0.004) for y in (0.0, 0.043)], [(face, y, 0.058) for y in (0.0, 0.043)]):
            pieces += _struts(
                (top[0], feet[0]), (feet[0], top[1]), (top[1], feet[1]), (feet[1], top[2]), (feet[0], feet[1])
            )
        pieces += _struts((top[0], top[2]))
    return pieces


def _corners(p: TangoParams) -> list[Piece]:
    """A K over each of the box's four vertical edges at the bottom."""
    pieces: list[Piece] = []
    for sx in (-1, 1):
        for sy, y in ((-1, p.box_low_y_m), (1, p.box_high_y_m)):
            out, x = y + sy * 0.008, sx * (p.half_length_m + 0.004)
            edge = [(sx * 0.205, y, -0.004), (sx * 0.318, y, -0.004), (x, y, 0.056), (x, y, 0.162)]
            node: Point = (sx * 0.290, out, 0.085)
            pieces += _struts(*((point, node) for point in edge))
            inner = y - sy * 0.024
            low, side = (sx * 0.262, inner, -0.004), (x, inner, 0.109)
            pieces += _struts((edge[0], low), (edge[1], low), (edge[2], side), (edge[3], side))
    return pieces


def _panel_corners(p: TangoParams) -> list[Piece]:
    """A triangle on the end plate and struts from it to the panel's corner."""
    pieces: list[Piece] = []
    for sx in (-1, 1):
        x = sx * (p.half_length_m + 0.004)
        for sy, y in ((-1, p.box_low_y_m), (1, p.box_high_y_m)):
            apex, low, high = (x, y - sy * 0.105, 0.247), (x, y - sy * 0.018, 0.203), (x, y - sy * 0.018, 0.290)
            corner = (sx * (p.half_length_m - 0.006), sy * (p.panel_half_width_m - 0.006), 0.245)
            under = (corner[0], corner[1], p.panel_bottom_m)
            pieces += _struts((apex, low), (apex, high), (low, high), (low, corner), (high, corner), (corner, under))
    return pieces


def _struts(*ends: tuple[Point, Point]) -> list[Piece]:
    return [rod("brackets", start, end, _STRUT_M) for start, end in ends]
