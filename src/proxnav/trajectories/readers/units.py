"""Units as files spell them, as factors to SI."""

import math

LENGTH = {
    "m": 1.0, "meter": 1.0, "meters": 1.0, "metre": 1.0, "metres": 1.0,
    "km": 1e3, "kilometer": 1e3, "kilometers": 1e3, "kilometre": 1e3, "kilometres": 1e3,
    "cm": 1e-2, "mm": 1e-3, "ft": 0.3048, "feet": 0.3048, "foot": 0.3048, "mi": 1609.344, "miles": 1609.344,
    "nm": 1852.0, "nmi": 1852.0, "nauticalmiles": 1852.0,
}  # fmt: skip
"""Metres."""

ANGLE = {"rad": 1.0, "radians": 1.0, "deg": math.pi / 180.0, "degrees": math.pi / 180.0}
"""Radians."""

TIME = {"s": 1.0, "sec": 1.0, "secs": 1.0, "seconds": 1.0, "epsec": 1.0, "min": 60.0, "epmin": 60.0}
TIME |= {"hr": 3600.0, "h": 3600.0, "ephr": 3600.0, "day": 86400.0, "days": 86400.0, "epday": 86400.0}
"""Seconds."""


def speed(name: str) -> float | None:
    """Factor to m/s of a unit such as km/sec, m/s, mps or km_s; None where it is unknown."""
    top, _, bottom = name.replace("_", "/").removesuffix("ps").partition("/")
    if name.endswith("ps") and not bottom:
        bottom = "s"
    return LENGTH[top] / TIME[bottom] if top in LENGTH and bottom in TIME else None


def angular_rate(name: str) -> float | None:
    """Factor to rad/s of a unit such as deg/sec; None where it is unknown."""
    top, _, bottom = name.replace("_", "/").partition("/")
    return ANGLE[top] / TIME[bottom] if top in ANGLE and bottom in TIME else None
