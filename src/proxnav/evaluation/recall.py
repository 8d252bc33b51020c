"""Share of frames whose pose is within limits of position and attitude; frames without a pose are not."""

from collections.abc import Mapping, Sequence

import numpy as np

from proxnav.errors import InputError
from proxnav.evaluation.pairing import PairedFrame

LIMITS: Mapping[str, tuple[float, float]] = {
    "1 cm 1 deg": (0.01, 1.0),
    "2 cm 2 deg": (0.02, 2.0),
    "5 cm 5 deg": (0.05, 5.0),
    "10 cm 10 deg": (0.10, 10.0),
}
"""Customary limits: position [m], attitude [deg]."""
RELATIVE: Mapping[str, tuple[float, float]] = {
    "1 % of range, 1 deg": (0.01, 1.0),
    "2 % of range, 2 deg": (0.02, 2.0),
    "5 % of range, 5 deg": (0.05, 5.0),
}
"""Limits for targets metres across: position over range, attitude [deg]."""


def recalls(frames: Sequence[PairedFrame], within: Sequence[str] = ()) -> dict[str, float]:
    """Share of frames within each limit, and within those of `within`, such as "0.2m,3deg"."""
    asked = {text: _limit(text) for text in within}
    found = {name: _share(frames, *limit) for name, limit in {**LIMITS, **asked}.items()}
    return found | {name: _relative_share(frames, *limit) for name, limit in RELATIVE.items()}


def _limit(text: str) -> tuple[float, float]:
    words = text.replace(" ", "").lower().split(",")
    units = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
    try:
        position, turn = words
        unit = next(unit for unit in units if position.endswith(unit))
        limit = float(position.removesuffix(unit)) * units[unit], float(turn.removesuffix("deg"))
    except (ValueError, StopIteration):
        raise InputError(f"--within {text}: expected a length and an angle, such as 0.2m,3deg") from None
    if not (turn.endswith("deg") and min(limit) > 0.0 and np.isfinite(limit).all()):
        raise InputError(f"--within {text}: expected a length and an angle above 0, such as 0.2m,3deg")
    return limit


def _share(frames: Sequence[PairedFrame], limit_m: float, limit_deg: float) -> float:
    inside = [
        f.errors is not None and f.errors.e_t_norm_m < limit_m and np.degrees(f.errors.e_r_rad) < limit_deg
        for f in frames
    ]
    return float(np.mean(inside))


def _relative_share(frames: Sequence[PairedFrame], limit: float, limit_deg: float) -> float:
    inside = [
        f.errors is not None and f.errors.e_tn < limit and np.degrees(f.errors.e_r_rad) < limit_deg for f in frames
    ]
    return float(np.mean(inside))
