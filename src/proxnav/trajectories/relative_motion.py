"""Relative motion about the target, as `proxnav.geometry.relative_motion` has it."""

from proxnav.geometry.relative_motion import cw_transition, eci_from_ric, ric_from_eci, ric_rate

__all__ = ["cw_transition", "eci_from_ric", "ric_from_eci", "ric_rate"]
