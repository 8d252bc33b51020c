"""What sits on the orbital module and makes its sides distinguishable: each device is on one side only."""

import numpy as np

from proxnav.targets.solids import Piece, aim, box, moved, revolve, rod
from proxnav.targets.space_rider.params import SpaceRiderParams

Point = tuple[float, float, float]


def equipment(p: SpaceRiderParams) -> list[Piece]:
    """Dish and star trackers on the left, radiator and low-gain antenna on the right, thrusters around the rear rim."""
    return [*_dish(p), *_star_trackers(p), *_radiator(p), *_low_gain_antenna(p), *_thruster_blocks(p)]


def on_hull(p: SpaceRiderParams, x: float, clock_deg: float, above_m: float = 0.0) -> Point:
    """Point on (or above) the cylinder; clock 0 is right (+y), 90 down (+z), 180 left, 270 up."""
    a, r = np.radians(clock_deg), p.module_radius_m + above_m
    return x, r * float(np.cos(a)), r * float(np.sin(a))


def dish_centre_m(p: SpaceRiderParams) -> Point:
    """Tip of the feed of the high-gain antenna, below left of the module."""
    return on_hull(p, p.module_aft_x_m + 0.35, 140.0, 0.62)


def low_gain_tip_m(p: SpaceRiderParams) -> Point:
    """End of the low-gain antenna's rod, above right of the module."""
    return on_hull(p, p.module_fore_x_m - 0.25, 300.0, 0.75)


def star_tracker_mouths_m(p: SpaceRiderParams) -> tuple[Point, Point]:
    """Centres of the baffles' openings, above left of the module."""
    x = p.module_fore_x_m - 0.28
    return on_hull(p, x, 228.0, 0.36), on_hull(p, x, 252.0, 0.36)


def radiator_corners_m(p: SpaceRiderParams) -> dict[str, Point]:
    """Corners of the radiator's outer face, below right of the module."""
    fore, aft = p.module_fore_x_m - 0.20, p.module_aft_x_m + 0.20
    return {
        "fore_up": on_hull(p, fore, 18.0, 0.09), "fore_down": on_hull(p, fore, 62.0, 0.09),
        "aft_up": on_hull(p, aft, 18.0, 0.09), "aft_down": on_hull(p, aft, 62.0, 0.09),
    }  # fmt: skip


def _dish(p: SpaceRiderParams) -> list[Piece]:
    tip = dish_centre_m(p)
    outward = (0.0, tip[1], tip[2])
    rise = [(0.16 * s * s, 0.34 * s) for s in (1.0, 0.75, 0.5, 0.25, 0.0)]
    back = [(x - 0.015, r) for x, r in reversed(rise)]
    bowl = revolve("dish", [*rise[::-1], *reversed(back)], 28)
    bowl = Piece("dish", bowl.vertices_m - [0.24, 0.0, 0.0], bowl.faces)
    foot = on_hull(p, tip[0], 140.0, -0.05)
    seat = on_hull(p, tip[0], 140.0, 0.37)
    feed = revolve("dish_feed", [(0.0, 0.0), (0.0, 0.035), (-0.24, 0.02), (-0.24, 0.0)], 12)
    return [aim(bowl, tip, outward), rod("dish_feed", foot, seat, 0.05), aim(feed, tip, outward)]


def _star_trackers(p: SpaceRiderParams) -> list[Piece]:
    profile = [(0.0, 0.0), (0.0, 0.10), (-0.38, 0.065), (-0.38, 0.0)]
    baffle = revolve("star_trackers", profile, 20)
    return [aim(baffle, mouth, (0.0, mouth[1], mouth[2])) for mouth in star_tracker_mouths_m(p)]


def _radiator(p: SpaceRiderParams) -> list[Piece]:
    """A flat panel on stand-offs, tangential to the cylinder at clock 40 deg."""
    corner = radiator_corners_m(p)
    outer = np.array([corner[k] for k in ("fore_up", "fore_down", "aft_down", "aft_up")])
    normal = np.array([0.0, np.cos(np.radians(40.0)), np.sin(np.radians(40.0))])
    solid = box("radiator", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    s, t, depth = solid.vertices_m.T
    top = outer[0] + s[:, None] * (outer[3] - outer[0]) + t[:, None] * (outer[1] - outer[0])
    vertices = top - (1 - depth)[:, None] * 0.12 * normal
    outward = np.dot(np.cross(outer[3] - outer[0], outer[1] - outer[0]), normal) > 0
    return [Piece("radiator", vertices, solid.faces if outward else solid.faces[:, ::-1])]


def _low_gain_antenna(p: SpaceRiderParams) -> list[Piece]:
    tip = low_gain_tip_m(p)
    foot = on_hull(p, tip[0], 300.0, -0.05)
    head = revolve("low_gain_antenna", [(0.0, 0.0), (0.0, 0.07), (-0.10, 0.07), (-0.10, 0.0)], 16)
    return [rod("low_gain_antenna", foot, tip, 0.03), aim(head, tip, (0.0, tip[1], tip[2]))]


def _thruster_blocks(p: SpaceRiderParams) -> list[Piece]:
    """Four blocks at the rear rim with one nozzle each."""
    pieces: list[Piece] = []
    for clock in (45.0, 135.0, 225.0, 315.0):
        x, y, z = on_hull(p, p.module_aft_x_m + 0.12, clock, 0.05)
        pieces.append(box("thrusters", (x - 0.1, y - 0.08, z - 0.08), (x + 0.1, y + 0.08, z + 0.08)))
        bell = revolve("thrusters", [(0.0, 0.0), (0.0, 0.02), (-0.14, 0.055), (-0.14, 0.0)], 12)
        pieces.append(moved(bell, (x - 0.1, y, z)))
    return pieces
