"""The re-entry module: lifting body, base, two body flaps."""

import numpy as np
from jaxtyping import Int, Shaped

from proxnav.targets.solids import Piece, box, loft_faces, moved, revolve
from proxnav.targets.space_rider.params import SpaceRiderParams
from proxnav.targets.space_rider.sections import SEAM_M, Sections, body_sections, mark_range_m

_BELLY, _CHINE, _SIDE, _SEAM, _DOOR, _MARK = range(6)


def reentry_module(p: SpaceRiderParams) -> list[Piece]:
    """All pieces of the lifting body, nose first."""
    sections = body_sections(p)
    return [*_skin(p, sections), *_base(p, sections), *(_flap(p, side) for side in (-1, 1)), *_base_thrusters(p)]


def flap_corners_m(p: SpaceRiderParams, side: int) -> dict[str, tuple[float, float, float]]:
    """Outer and inner corner of the trailing edge of the left (-1) or right (+1) flap, lower surface."""
    x, z = _flap_tip(p)
    inner, outer = side * p.flap_gap_m / 2, side * (p.flap_gap_m / 2 + p.flap_width_m)
    return {"inner": (x, inner, z), "outer": (x, outer, z)}


def _skin(p: SpaceRiderParams, sections: Sections) -> list[Piece]:
    """The loft and its nose, cut into parts by zone."""
    n_stations, n_ring = sections.points_m.shape[:2]
    vertices = np.concatenate([sections.points_m.reshape(-1, 3), [[p.nose_x_m, 0.0, p.nose_drop_m]]])
    ring = np.arange(n_ring)
    nose = np.stack([np.full(n_ring, len(vertices) - 1), (ring + 1) % n_ring, ring], axis=1)
    faces = loft_faces(n_stations, n_ring)
    names = np.concatenate([np.full(n_ring, "nose_cap"), _part_of_faces(p, sections)])
    faces = np.concatenate([nose, faces])
    return [Piece(str(name), vertices, faces[names == name]) for name in dict.fromkeys(names)]


def _part_of_faces(p: SpaceRiderParams, sections: Sections) -> Shaped[np.ndarray, "n_faces"]:
    """Part names of the loft's triangles, in the order of `loft_faces`."""
    d = (sections.distance_m[:-1, None] + sections.distance_m[1:, None]) / 2
    zone, right = sections.zone[None, :], sections.right[None, :]
    zone, right = np.broadcast_to(zone, (len(d), zone.size)), np.broadcast_to(right, (len(d), right.size))
    part = np.where((zone == _BELLY) | (zone == _CHINE), "belly", "leeside").astype("<U16")
    bay = (d > p.door_fore_m) & (d < p.door_aft_m)
    frame = (d < p.door_fore_m + SEAM_M) | (d > p.door_aft_m - SEAM_M)
    part[bay & ((zone == _SEAM) | ((zone == _DOOR) & frame))] = "door_seam"
    part[bay & (zone == _DOOR) & ~frame] = "cargo_doors"
    fore, aft = mark_range_m(p)
    marked = (zone == _MARK) & (d > fore) & (d < aft)
    part[marked & ~right] = "marking_left"
    part[d[:, 0] < p.nose_cap_depth_m] = "nose_cap"
    return np.repeat(part.reshape(-1), 2)


def _base(p: SpaceRiderParams, sections: Sections) -> list[Piece]:
    """The flat rear end, slightly inside the last ring's plane so that it closes the body."""
    ring = sections.points_m[-1]
    n = len(ring)
    middle = [p.base_x_m, 0.0, float(ring[:, 2].mean())]
    index = np.arange(n)
    faces: Int[np.ndarray, "n_faces 3"] = np.stack([np.full(n, n), index, (index + 1) % n], axis=1)
    return [Piece("body_base", np.concatenate([ring, [middle]]), faces)]


def _flap_hinge_z(p: SpaceRiderParams) -> float:
    return 0.90 * (p.body_height_m / 2 - p.nose_drop_m) + p.nose_drop_m


def _flap_tip(p: SpaceRiderParams) -> tuple[float, float]:
    """x and z of the trailing edge, lower surface."""
    angle = np.radians(p.flap_deflection_deg)
    return p.base_x_m - p.flap_chord_m * float(np.cos(angle)), _flap_hinge_z(p) + p.flap_chord_m * float(np.sin(angle))


def _flap(p: SpaceRiderParams, side: int) -> Piece:
    """A plate hinged at the belly's rear edge, trailing edge down."""
    x_tip, z_tip = _flap_tip(p)
    inner, outer = sorted((side * p.flap_gap_m / 2, side * (p.flap_gap_m / 2 + p.flap_width_m)))
    flat = box("flap_left" if side < 0 else "flap_right", (0.0, inner, -p.flap_thickness_m), (1.0, outer, 0.0))
    aft = 1.0 - flat.vertices_m[:, 0]
    x = (p.base_x_m + 0.03) * (1 - aft) + x_tip * aft
    z = flat.vertices_m[:, 2] + (_flap_hinge_z(p) - 0.01) * (1 - aft) + z_tip * aft
    return Piece(flat.part, np.stack([x, flat.vertices_m[:, 1], z], axis=1), flat.faces)


def _base_thrusters(p: SpaceRiderParams) -> list[Piece]:
    """Attitude-control nozzles at the base, two a side."""
    bell = revolve("thrusters", [(0.0, 0.0), (0.0, 0.03), (-0.12, 0.06), (-0.12, 0.0)], 12)
    places = [(y * p.body_width_m, z * p.body_height_m) for y in (-0.36, 0.36) for z in (0.05, 0.17)]
    return [moved(bell, (p.base_x_m, y, z)) for y, z in places]
