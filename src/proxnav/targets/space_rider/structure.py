"""Structural points of Space Rider that a camera can recognise: the candidates for keypoints."""

import numpy as np
from jaxtyping import Float

from proxnav.targets.space_rider import equipment
from proxnav.targets.space_rider.params import SpaceRiderParams
from proxnav.targets.space_rider.reentry_module import flap_corners_m
from proxnav.targets.space_rider.sections import DOOR_ANGLE, LEE_ANGLES, N_BELLY, N_CHINE, body_sections
from proxnav.targets.space_rider.wings import wing_corners_m

Point = tuple[float, float, float]
SIDES = ((-1, "left"), (1, "right"))


def structural_points(p: SpaceRiderParams) -> dict[str, Point]:
    """Named corners and tips on the surface, in the target frame."""
    points: dict[str, Point] = {"nose_tip": (p.nose_x_m, 0.0, p.nose_drop_m)}
    for side, name in SIDES:
        points |= {f"wing_{name}_{corner}": point for corner, point in wing_corners_m(p, side).items()}
        points |= {f"flap_{name}_{corner}": point for corner, point in flap_corners_m(p, side).items()}
    return points | _body_points(p) | _module_points(p)


def _body_points(p: SpaceRiderParams) -> dict[str, Point]:
    sections = body_sections(p)
    chine, top = N_BELLY + N_CHINE - 1, N_BELLY + N_CHINE + len(LEE_ANGLES) - 2
    door = N_BELLY + N_CHINE - 1 + int(np.argmin(np.abs(LEE_ANGLES - DOOR_ANGLE)))
    at = {name: _ring(sections.distance_m, d) for name, d in _stations(p).items()}
    points = {"base_top": sections.points_m[-1, top], "nose_rim_bottom": sections.points_m[at["nose_rim"], 0]}
    for side, name in SIDES:
        mirror = np.array([1.0, side, 1.0])
        points[f"base_chine_{name}"] = sections.points_m[-1, chine] * mirror
        points[f"nose_rim_{name}"] = sections.points_m[at["nose_rim"], chine] * mirror
        points[f"door_fore_{name}"] = sections.points_m[at["door_fore"], door] * mirror
        points[f"door_aft_{name}"] = sections.points_m[at["door_aft"], door] * mirror
    return {name: _point(value) for name, value in points.items()}


def _stations(p: SpaceRiderParams) -> dict[str, float]:
    return {"nose_rim": p.nose_cap_depth_m, "door_fore": p.door_fore_m, "door_aft": p.door_aft_m}


def _module_points(p: SpaceRiderParams) -> dict[str, Point]:
    exit_x, r, wide = -p.nose_x_m, p.nozzle_exit_radius_m, 0.02
    points = {f"nozzle_{name}": (exit_x, 0.0, sign * r) for name, sign in (("top", -1), ("bottom", 1))}
    for end, x in (("fore", p.module_fore_x_m + 0.035), ("aft", p.module_aft_x_m - 0.035)):
        for name, clock in (("right", 0.0), ("bottom", 90.0), ("left", 180.0), ("top", 270.0)):
            points[f"module_{end}_{name}"] = equipment.on_hull(p, x, clock, wide)
    points |= {f"radiator_{corner}": point for corner, point in equipment.radiator_corners_m(p).items()}
    upper, lower = reversed(equipment.star_tracker_mouths_m(p))
    points |= {"dish_feed_tip": equipment.dish_centre_m(p), "low_gain_antenna_tip": equipment.low_gain_tip_m(p)}
    return points | {"star_tracker_upper": upper, "star_tracker_lower": lower}


def _ring(distance_m: Float[np.ndarray, "n_stations"], wanted_m: float) -> int:
    return int(np.argmin(np.abs(distance_m - wanted_m)))


def _point(value: Float[np.ndarray, "3"]) -> Point:
    return float(value[0]), float(value[1]), float(value[2])
