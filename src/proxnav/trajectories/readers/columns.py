"""What a column means, of which object, in which unit: from its header, as the tools write headers."""

import re
from dataclasses import dataclass, replace

from proxnav.trajectories.readers.reference_frames import FrameKind, frame_kind
from proxnav.trajectories.readers.units import ANGLE, LENGTH, TIME, angular_rate, speed

_ALIASES = {
    "t": "t time epsec elapsedtime timeutcg utcg utc date epoch timestamp seconds",
    "x": "x rx rhox relx relposx posx positionx xpos ecix j2000x xeci rx eciposx r1 rn1",
    "y": "y ry rhoy rely relposy posy positiony ypos eciy j2000y yeci eciposy r2 rn2",
    "z": "z rz rhoz relz relposz posz positionz zpos eciz j2000z zeci eciposz r3 rn3",
    "vx": "vx xdot rhodotx relvx relvelx dx velx velocityx ecidx ecivx vxeci xvel v1 vn1",
    "vy": "vy ydot rhodoty relvy relvely dy vely velocityy ecidy ecivy vyeci yvel v2 vn2",
    "vz": "vz zdot rhodotz relvz relvelz dz velz velocityz ecidz ecivz vzeci zvel v3 vn3",
    "radial": "radial r rr",
    "intrack": "intrack i intrackdistance alongtrack downtrack transverse rt ri",
    "crosstrack": "crosstrack c crosstrackdistance rn rc",
    "radialrate": "radialrate radialvel radialvelocity rdot vr",
    "intrackrate": "intrackrate intrackvel intrackvelocity idot alongtrackrate vt vi",
    "crosstrackrate": "crosstrackrate crosstrackvel crosstrackvelocity cdot vn vc",
    "vbar": "vbar",
    "hbar": "hbar",
    "rbar": "rbar",
    "vbarrate": "vbarrate vbardot vbarvel vvbar",
    "hbarrate": "hbarrate hbardot hbarvel vhbar",
    "rbarrate": "rbarrate rbardot rbarvel vrbar",
    "qw": "qw beta0 eps0 q0 qs scalar",
    "qx": "qx beta1",
    "qy": "qy beta2",
    "qz": "qz beta3",
    "q1": "q1",
    "q2": "q2",
    "q3": "q3",
    "q4": "q4",
    "wx": "wx omega1 omegax ratex",
    "wy": "wy omega2 omegay ratey",
    "wz": "wz omega3 omegaz ratez",
}
_LETTERS = {"r": "radial", "t": "intrack", "s": "intrack", "n": "crosstrack", "w": "crosstrack"}
"""Axis that a letter names in a column such as RTN_T or RSW_S, where t is not the time."""
_MEANING = {alias: meaning for meaning, aliases in _ALIASES.items() for alias in aliases.split()}
_WITH_UNIT = re.compile(r"(?P<name>.*?)\s*[\[(](?P<unit>[^\])]*)[\])]\s*")
_UNIT_SUFFIX = re.compile(r"(?P<name>.*?)_(?P<unit>km_s|m_s|kmps|mps|km|m|deg|rad|deg_s|rad_s|s|sec|radps)_?")
_OF_A_QUATERNION = re.compile(r"q(uat\w*)?(_|$)", re.IGNORECASE)
_OWNED = re.compile(r"(?P<object>.+?)\s+-\s+(?P<name>.+)")


@dataclass(frozen=True, slots=True)
class Triad:
    """Three meanings that make a position, those that make its velocity, and the axes that their names alone say."""

    places: tuple[str, str, str]
    speeds: tuple[str, str, str]
    frame: FrameKind | None = None


TRIADS = (
    Triad(("radial", "intrack", "crosstrack"), ("radialrate", "intrackrate", "crosstrackrate"), "ric"),
    Triad(("vbar", "hbar", "rbar"), ("vbarrate", "hbarrate", "rbarrate"), "lvlh"),
    Triad(("x", "y", "z"), ("vx", "vy", "vz")),
)


@dataclass(frozen=True, slots=True)
class Column:
    """One column, understood."""

    header: str
    index: int
    meaning: str
    """A key of the alias table; empty where the column is not used."""
    owner: str
    """Name of the object; empty where the header names none."""
    unit: str
    """Lower case as written; empty where the header has none."""
    frame: FrameKind | None = None
    """Axes that the header names, as in r_ric_x_m; None where it names none."""

    @property
    def is_rate(self) -> bool:
        """Whether it is a speed."""
        return any(self.meaning in triad.speeds for triad in TRIADS)

    @property
    def factor(self) -> float | None:
        """To SI; None where the unit is absent or unknown for this quantity."""
        if self.is_rate:
            return speed(self.unit)
        if self.meaning in ("wx", "wy", "wz"):
            return angular_rate(self.unit)
        table = TIME if self.meaning == "t" else LENGTH
        return table.get(self.unit)


def understand(headers: tuple[str, ...]) -> list[Column]:
    """The columns of a header; one whose object is missing between columns of one object belongs to that object."""
    columns = [_column(header, index) for index, header in enumerate(headers)]
    for k in range(1, len(columns) - 1):
        before, here, after = columns[k - 1 : k + 2]
        if here.meaning not in ("", "t") and not here.owner and before.owner and before.owner == after.owner:
            columns[k] = replace(here, owner=before.owner)
    return columns


def named_components(name: str, count: int) -> tuple[str, ...]:
    """Headers of the columns of an array of that name: of a vector its components, of four numbers a quaternion's.

    >>> named_components("r_ric_m", 3)
    ('r_ric_x (m)', 'r_ric_y (m)', 'r_ric_z (m)')
    >>> named_components("t", 1), named_components("q", 4)
    (('t',), ('q1', 'q2', 'q3', 'q4'))
    """
    if count == 1:
        return (name,)
    if count == 4:
        return tuple(f"{name}{k}" for k in range(1, 5))
    text, unit = name, ""
    if match := _UNIT_SUFFIX.fullmatch(name):
        text, unit = match["name"], f" ({match['unit']})"
    return tuple(f"{text}_{axis}{unit}" for axis in "xyzuvw"[:count])


def _column(header: str, index: int) -> Column:
    """
    >>> _column("sat1 - vx (km/sec)", 4)
    Column(header='sat1 - vx (km/sec)', index=4, meaning='vx', owner='sat1', unit='km/sec', frame=None)
    """
    text, unit = header.strip().strip('"'), ""
    if match := _WITH_UNIT.fullmatch(text):
        text, unit = match["name"], match["unit"]
    owner = ""
    if match := _OWNED.fullmatch(text):
        owner, text = match["object"], match["name"]
    meaning, suffix_owner, suffix_unit, frame = *_meaning(text), None
    bare, named = _without_frame(text)
    if named == "ric" and bare.lower() in _LETTERS:
        meaning, suffix_owner, frame = _LETTERS[bare.lower()], "", named
    elif named is not None and (inner := _meaning(bare))[0]:
        (meaning, suffix_owner, suffix_unit), frame = inner, named
    unit = (unit or suffix_unit).strip().lower()
    if meaning in ("x", "y", "z") and (unit in ANGLE or angular_rate(unit) is not None):
        meaning = ""  # an angle's or a rate's component, such as rate_target_x_rad_s
    return Column(header, index, meaning, owner or suffix_owner, unit, frame)


def _without_frame(text: str) -> tuple[str, FrameKind | None]:
    """A name without the word for its axes, and these axes: of 'r_ric_x_m' it is ('r_x_m', 'ric')."""
    words = re.split(r"([ _.]+)", text)
    for k in range(0, len(words), 2):
        if len(words) > 1 and len(words[k]) > 2 and (kind := frame_kind(words[k])) is not None:
            return "".join(words[:k] + words[k + 2 :]).strip(" _."), kind
    return text, None


def _meaning(text: str) -> tuple[str, str, str]:
    """(meaning, object, unit) of a bare name such as 'ECI X_1', 'chaser_vx' or 'x_km_'."""
    if (plain := _plain(text)) in _MEANING:
        return _MEANING[plain], "", ""
    if match := _UNIT_SUFFIX.fullmatch(text):
        meaning, owner, _ = _meaning(match["name"])
        if meaning:
            return meaning, owner, match["unit"]
    for cut in (i for i, c in enumerate(text) if c in "_."):
        left, right = text[:cut], text[cut + 1 :]
        if _OF_A_QUATERNION.match(left):  # q_cam_target_x is no position
            continue
        if left and right and _plain(left) in _MEANING:
            return _MEANING[_plain(left)], right, ""
        if left and right and _plain(right) in _MEANING:
            return _MEANING[_plain(right)], left, ""
    return "", "", ""


def _plain(text: str) -> str:
    return "".join(c for c in text.lower() if c.isalnum())
