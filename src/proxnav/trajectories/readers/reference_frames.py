"""Names of reference frames in other tools' files, and their rotation to ECI.

TEME and true-of-date axes are taken as mean-of-date: nutation (0.005 deg) is left out, as everywhere in this package.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.geometry.celestial import EARTH_RATE, q_eci_ecef, q_eci_mod
from proxnav.geometry.epochs import Instant
from proxnav.geometry.types import QuatWxyz, Vector3

FrameKind = Literal["eci", "ecef", "of_date", "of_epoch", "ric", "lvlh"]

_KINDS: dict[str, FrameKind] = {
    "icrf": "eci", "j2000": "eci", "eme2000": "eci", "gcrf": "eci", "inertial": "eci", "eci": "eci", "gcrs": "eci",
    "fixed": "ecef", "itrf": "ecef", "ecef": "ecef", "ecf": "ecef", "wgs84": "ecef", "itrf2000": "ecef",
    "itrf97": "ecef", "itrf93": "ecef", "itrf2008": "ecef", "itrf2014": "ecef", "itrf2020": "ecef", "grc": "ecef",
    "teme": "of_date", "temeofdate": "of_date", "meanofdate": "of_date", "trueofdate": "of_date", "tod": "of_date",
    "temeofepoch": "of_epoch", "meanofepoch": "of_epoch", "trueofepoch": "of_epoch",
    "ric": "ric", "rtn": "ric", "rsw": "ric",
    "lvlh": "lvlh", "vvlh": "lvlh", "lvlhrotating": "lvlh", "vvlhcbearth": "lvlh",
}  # fmt: skip


ORBITAL: tuple[FrameKind, ...] = ("ric", "lvlh")
"""Axes that follow a craft's own orbit; ric: radial, in-track, cross-track; lvlh: ahead, against the normal, nadir."""


@dataclass(frozen=True, slots=True)
class ReferenceFrame:
    """Axes that positions or attitudes refer to, at Earth's centre."""

    kind: FrameKind
    epoch: Instant | None = None
    """Epoch at which a frame is frozen; None for frames of date and inertial ones."""


def frame_kind(name: str) -> FrameKind | None:
    """The kind of frame that a name means; None where it is unknown.

    >>> frame_kind("ITRF-97"), frame_kind("J2000"), frame_kind("B1950")
    ('ecef', 'eci', None)
    """
    return _KINDS.get("".join(c for c in name.lower() if c.isalnum()))


def q_eci_frame(frame: ReferenceFrame, epoch: Instant, t: Float[np.ndarray, "n"]) -> QuatWxyz:
    """Attitude of the frame's axes in ECI at `t` seconds after `epoch`, (n, 4)."""
    if frame.kind == "eci":
        return np.tile(quaternion.IDENTITY, (len(t), 1))
    if frame.kind == "ecef":
        return q_eci_ecef(epoch.iso(9), t)
    if frame.kind == "of_date":
        return q_eci_mod(epoch.iso(9), t)
    if frame.kind == "of_epoch":
        return q_eci_mod((frame.epoch or epoch).iso(9), np.zeros_like(t))
    raise AssertionError("orbital axes are turned to ECI with the craft's orbit, by the reader")


def state_to_eci(
    frame: ReferenceFrame, epoch: Instant, t: Float[np.ndarray, "n"], r: Vector3, v: Vector3
) -> tuple[Vector3, Vector3]:
    """(r, v) in ECI of states in the frame; in Earth-fixed axes `v` is relative to the turning Earth."""
    q = q_eci_frame(frame, epoch, t)
    rate = np.array([0.0, 0.0, EARTH_RATE if frame.kind == "ecef" else 0.0])
    return quaternion.rotate(q, r), quaternion.rotate(q, v + np.cross(rate, r))
