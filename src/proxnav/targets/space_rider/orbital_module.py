"""The orbital module: adapter, foil-wrapped cylinder, tanks, engine."""

from proxnav.targets.solids import Piece, ball, revolve
from proxnav.targets.space_rider.params import SpaceRiderParams

RIM_M = 0.07
"""Width of the metal rings at both ends of the cylinder."""


def orbital_module(p: SpaceRiderParams) -> list[Piece]:
    """All pieces on the stack's axis behind the lifting body, front first."""
    fore, aft, r = p.module_fore_x_m, p.module_aft_x_m, p.module_radius_m
    neck = p.base_x_m - 0.45 * p.adapter_length_m
    adapter = [(p.base_x_m, 0.0), (p.base_x_m, p.adapter_radius_m), (neck, 1.08 * p.adapter_radius_m)]
    pieces = [revolve("adapter", [*adapter, (fore, 0.97 * r), (fore, 0.0)], 48)]
    pieces += [_ring(fore, r), _drum("module_foil", fore, aft, r), _ring(aft, r)]
    return [*pieces, *_tanks(p), *_engine(p)]


def _ring(x: float, radius: float) -> Piece:
    return _drum("module_rims", x + RIM_M / 2, x - RIM_M / 2, radius + 0.02)


def _drum(part: str, fore: float, aft: float, radius: float) -> Piece:
    return revolve(part, [(fore, 0.0), (fore, radius), (aft, radius), (aft, 0.0)], 64)


def _tanks(p: SpaceRiderParams) -> list[Piece]:
    """Four spherical propellant tanks half sunk in the rear deck."""
    d, r = 0.54 * p.module_radius_m, 0.30 * p.module_radius_m
    return [ball("tanks", (p.module_aft_x_m - 0.10, y, z), r) for y, z in ((d, 0.0), (-d, 0.0), (0.0, d), (0.0, -d))]


def _engine(p: SpaceRiderParams) -> list[Piece]:
    """Mount and bell; the bell is a thin shell, open to the rear."""
    aft, exit_x, wall = p.module_aft_x_m, -p.nose_x_m, 0.012
    throat, length = aft - 0.25 * p.engine_length_m, 0.75 * p.engine_length_m
    cone = [(aft, 0.30 * p.module_radius_m), (throat, p.nozzle_throat_radius_m)]
    mount = revolve("engine", [(aft, 0.0), *cone, (throat, 0.0)], 32)
    steps = [i / 8 for i in range(9)]
    bell = [(throat - length * s, _bell_radius(p, s)) for s in steps]
    inner = [(x, r - wall) for x, r in reversed(bell)]
    return [mount, revolve("nozzle", [(throat, 0.0), *bell, (exit_x, bell[-1][1]), *inner, (throat - 0.01, 0.0)], 40)]


def _bell_radius(p: SpaceRiderParams, s: float) -> float:
    """Parabolic bell: steep at the throat, nearly cylindrical at the exit."""
    return p.nozzle_throat_radius_m + (p.nozzle_exit_radius_m - p.nozzle_throat_radius_m) * (1 - (1 - s) ** 1.8)
