"""What a column means, of which object, in which unit: from its header, as the tools write headers."""

import re
from dataclasses import dataclass, replace

from proxnav.trajectories.readers.units import LENGTH, TIME, angular_rate, speed

_ALIASES = {
    "t": "t time epsec elapsedtime timeutcg utcg utc date epoch timestamp seconds",
    "x": "x rx posx positionx xpos ecix j2000x xeci rx eciposx r1 rn1",
    "y": "y ry posy positiony ypos eciy j2000y yeci eciposy r2 rn2",
    "z": "z rz posz positionz zpos eciz j2000z zeci eciposz r3 rn3",
    "vx": "vx xdot dx velx velocityx ecidx ecivx vxeci xvel v1 vn1",
    "vy": "vy ydot dy vely velocityy ecidy ecivy vyeci yvel v2 vn2",
    "vz": "vz zdot dz velz velocityz ecidz ecivz vzeci zvel v3 vn3",
    "radial": "radial r",
    "intrack": "intrack i intrackdistance",
    "crosstrack": "crosstrack c crosstrackdistance",
    "radialrate": "radialrate radialvel rdot",
    "intrackrate": "intrackrate intrackvel idot",
    "crosstrackrate": "crosstrackrate crosstrackvel cdot",
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
_MEANING = {alias: meaning for meaning, aliases in _ALIASES.items() for alias in aliases.split()}
_WITH_UNIT = re.compile(r"(?P<name>.*?)\s*[\[(](?P<unit>[^\])]*)[\])]\s*")
_UNIT_SUFFIX = re.compile(r"(?P<name>.*?)_(?P<unit>km_s|m_s|kmps|mps|km|m|deg|rad|deg_s|rad_s|s|sec|radps)_?")
_OWNED = re.compile(r"(?P<object>.+?)\s+-\s+(?P<name>.+)")


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

    @property
    def factor(self) -> float | None:
        """To SI; None where the unit is absent or unknown for this quantity."""
        if self.meaning in ("vx", "vy", "vz") or self.meaning.endswith("rate"):
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


def _column(header: str, index: int) -> Column:
    """
    >>> _column("sat1 - vx (km/sec)", 4)
    Column(header='sat1 - vx (km/sec)', index=4, meaning='vx', owner='sat1', unit='km/sec')
    """
    text, unit = header.strip().strip('"'), ""
    if match := _WITH_UNIT.fullmatch(text):
        text, unit = match["name"], match["unit"]
    owner = ""
    if match := _OWNED.fullmatch(text):
        owner, text = match["object"], match["name"]
    meaning, suffix_owner, suffix_unit = _meaning(text)
    return Column(header, index, meaning, owner or suffix_owner, (unit or suffix_unit).strip().lower())


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
        if left and right and _plain(left) in _MEANING:
            return _MEANING[_plain(left)], right, ""
        if left and right and _plain(right) in _MEANING:
            return _MEANING[_plain(right)], left, ""
    return "", "", ""


def _plain(text: str) -> str:
    return "".join(c for c in text.lower() if c.isalnum())
