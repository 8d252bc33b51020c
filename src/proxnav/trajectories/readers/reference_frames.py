"""Names of reference frames in other tools' files, and their rotation to ECI, which is the ICRF's axes.

Mean- and true-of-date axes differ by the model of precession and nutation that their tool has: they are taken as mean
of date, to 0.005 deg, which is enough where both craft are given in them and refused where they are not.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.celestial import EARTH_RATE, q_eci_mod
from proxnav.geometry.epochs import Instant
from proxnav.geometry.types import QuatWxyz, Rotation3x3, Vector3
from proxnav.trajectories.earth_orientation import (
    R_icrs_j2000,
    R_icrs_tirs,
    R_tirs_itrs,
    R_tirs_teme,
    is_oriented,
    oriented_until,
)

FrameKind = Literal[
    "eci", "j2000", "ecef", "teme", "mean_of_date", "true_of_date", "mean_of_epoch", "true_of_epoch", "teme_of_epoch",
    "ric", "lvlh",
]  # fmt: skip

_KINDS: dict[str, FrameKind] = {
    "icrf": "eci", "gcrf": "eci", "gcrs": "eci", "icrs": "eci", "inertial": "eci", "eci": "eci",
    "j2000": "j2000", "eme2000": "j2000",
    "fixed": "ecef", "itrf": "ecef", "ecef": "ecef", "ecf": "ecef", "wgs84": "ecef", "itrf2000": "ecef",
    "itrf97": "ecef", "itrf93": "ecef", "itrf2008": "ecef", "itrf2014": "ecef", "itrf2020": "ecef", "grc": "ecef",
    "teme": "teme", "temeofdate": "teme", "meanofdate": "mean_of_date",
    "trueofdate": "true_of_date", "tod": "true_of_date",
    "temeofepoch": "teme_of_epoch", "meanofepoch": "mean_of_epoch", "trueofepoch": "true_of_epoch",
    "ric": "ric", "rtn": "ric", "rsw": "ric", "qsw": "ric", "hill": "ric",
    "lvlh": "lvlh", "vvlh": "lvlh", "lvlhrotating": "lvlh", "lvlhccsds": "lvlh", "vvlhcbearth": "lvlh",
    "vbarhbarrbar": "lvlh",
}  # fmt: skip

ORBITAL: tuple[FrameKind, ...] = ("ric", "lvlh")
"""Axes that follow a craft's own orbit; ric: radial, in-track, cross-track; lvlh: ahead, against the normal, nadir."""

AXES: dict[FrameKind, str] = {
    "ric": "RIC (x radial outward, y in-track, z along r x v; also called RTN, RSW, Hill)",
    "lvlh": "LVLH (x ahead, V-bar; y against r x v, H-bar; z to nadir, R-bar)",
}
"""What the orbital axes are, for people."""

FRAME_NAMES = "RIC, RTN, RSW, Hill, LVLH or VVLH for relative positions; ICRF, J2000, Fixed, TEMEOfDate or MeanOfDate"

_R_RIC_LVLH = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
_EXACT = {"eci", "j2000", "ecef", "teme"}


@dataclass(frozen=True, slots=True)
class ReferenceFrame:
    """Axes that positions or attitudes refer to, at Earth's centre."""

    kind: FrameKind
    epoch: Instant | None = None
    """Epoch at which a frame is frozen; None for frames of date and inertial ones."""

    @property
    def is_frozen(self) -> bool:
        """Whether it needs an epoch."""
        return self.kind.endswith("of_epoch")


def frame_kind(name: str) -> FrameKind | None:
    """The kind of frame that a name means; None where it is unknown.

    >>> frame_kind("ITRF-97"), frame_kind("J2000"), frame_kind("B1950")
    ('ecef', 'j2000', None)
    """
    return _KINDS.get("".join(c for c in name.lower() if c.isalnum()))


def ric_from_lvlh(vectors: Vector3) -> Vector3:
    """Positions or rates in LVLH axes (ahead, against the orbit's normal, nadir) in RIC axes.

    >>> ric_from_lvlh(np.array([-30.0, 2.0, 5.0]))  # 30 m behind, 2 m to the south on an eastward orbit, 5 m below
    array([ -5., -30.,  -2.])
    """
    return vectors @ _R_RIC_LVLH.T


def q_eci_frame(frame: ReferenceFrame, epoch: Instant, t: Float[np.ndarray, "n"]) -> QuatWxyz:
    """Attitude of the frame's axes in ECI at `t` seconds after `epoch`, (n, 4)."""
    if frame.kind.endswith("of_date"):
        return q_eci_mod(epoch.iso(9), t)
    if frame.is_frozen:
        return q_eci_mod((frame.epoch or epoch).iso(9), np.zeros_like(t))
    return quaternion.from_matrix(_R_eci_frame(frame, epoch, t))


def state_to_eci(
    frame: ReferenceFrame, epoch: Instant, t: Float[np.ndarray, "n"], r: Vector3, v: Vector3
) -> tuple[Vector3, Vector3]:
    """(r, v) in ECI of states in the frame; in Earth-fixed axes `v` is relative to the turning Earth."""
    if frame.kind == "eci":
        return r, v
    if frame.kind != "ecef":
        q = q_eci_frame(frame, epoch, t)
        return quaternion.rotate(q, r), quaternion.rotate(q, v)
    pole, turn = R_tirs_itrs(epoch, t), R_icrs_tirs(epoch, t)
    r, v = _times(pole, r), _times(pole, v)
    return _times(turn, r), _times(turn, v + np.cross([0.0, 0.0, EARTH_RATE], r))


def check_together(frames: Sequence[tuple[str, ReferenceFrame]], epoch: Instant, t: Float[np.ndarray, "n"]) -> None:
    """InputError where relative positions of orbits, (file, frame) each, would be wrong by metres or more."""
    (file, first), *others = frames
    for other_file, other in others:
        if other == first:
            continue
        vague = next((f for f in (first, other) if f.kind not in _EXACT), None)
        if vague is not None:
            raise InputError(
                f"{file} and {other_file} are in different axes, one of them of-date or of-epoch, which each "
                "tool computes by a model of its own: export both in ICRF, J2000 or Fixed"
            )
        if "ecef" in (first.kind, other.kind) and not is_oriented(epoch, t):
            raise InputError(
                f"{file} and {other_file} are in inertial and in Earth-fixed axes at {epoch.iso()}, and Earth's turn "
                f"is known until {oriented_until().iso()}: export both in one frame, or update astropy-iers-data"
            )


def _R_eci_frame(frame: ReferenceFrame, epoch: Instant, t: Float[np.ndarray, "n"]) -> Rotation3x3:
    if frame.kind == "eci":
        return np.tile(np.eye(3), (len(t), 1, 1))
    if frame.kind == "j2000":
        return np.tile(R_icrs_j2000(), (len(t), 1, 1))
    if frame.kind == "ecef":
        return R_icrs_tirs(epoch, t) @ R_tirs_itrs(epoch, t)
    if frame.kind == "teme":
        return R_icrs_tirs(epoch, t) @ R_tirs_teme(epoch, t)
    raise AssertionError("orbital axes are turned to ECI with the craft's orbit, by the reader")


def _times(R: Rotation3x3, v: Vector3) -> Vector3:
    return (R @ v[..., None])[..., 0]
