"""CCSDS messages in XML (505.0-B, NDM/XML): the same sections as in KVN. Lines are not known, records are counted."""

from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from proxnav.errors import InputError
from proxnav.geometry.epochs import Instant
from proxnav.trajectories.readers.ccsds_sections import MetaSection, parse_epoch
from proxnav.trajectories.readers.text import fail, number, read_lines

_STATE = ("X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT", "X_DDOT", "Y_DDOT", "Z_DDOT")
_QUATERNION = ("Q1", "Q2", "Q3", "QC")
_ANGLES = ("ANGLE_1", "ANGLE_2", "ANGLE_3")
_UNITS = {"X": "km", "X_DOT": "km/s", "ANGLE_1": "deg"}


def read_xml(path: str | Path, kind: str) -> list[MetaSection]:
    """Sections of an XML message, or of those of that kind in a combined one; `kind` is OEM or AEM."""
    root = _root(path)
    messages = [root] if root.tag == kind.lower() else root.findall(kind.lower())
    if not messages:
        raise InputError(f"{path}: an XML file of <{root.tag}>, without <{kind.lower()}>; export an OEM or AEM")
    found = []
    for message in messages:
        for segment in message.iter("segment"):
            found.append(_section(path, len(found) + 1, message.get("version", ""), segment, kind))
    if not found:
        raise InputError(f"{path}: <{kind.lower()}> holds no <segment>; the file is cut off: export it again")
    return found


def xml_kinds(path: str | Path) -> tuple[str, ...]:
    """Which of OEM and AEM an XML file holds; InputError for neither."""
    root = _root(path)
    kinds = tuple(kind for kind in ("OEM", "AEM") if root.tag == kind.lower() or root.find(kind.lower()) is not None)
    if not kinds:
        raise InputError(
            f"{path}: an XML file of <{root.tag}>; a trajectory is an <oem>, an <aem>, or an <ndm> of them"
        )
    return kinds


def _root(path: str | Path) -> Element:
    """The document without name spaces; entities, with which a small file can fill all memory, are refused."""
    text = "\n".join(read_lines(path))
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise InputError(f"{path}: declares a document type or entities, which no CCSDS message needs; remove them")
    try:
        root = ElementTree.fromstring(text.encode())
    except ElementTree.ParseError as error:
        raise InputError(f"{path}: not readable as XML ({error}); it may be cut off: export it again") from None
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""
    return root


def _section(path: str | Path, count: int, version: str, segment: Element, kind: str) -> MetaSection:
    metadata, data = segment.find("metadata"), segment.find("data")
    if metadata is None or data is None:
        fail(path, count, "this <segment> lacks <metadata> or <data>; the file is cut off")
    section = MetaSection(count, version, {e.tag: _text(e) for e in metadata.iter() if e is not metadata})
    section.covariances = len(data.findall("covarianceMatrix"))
    names = {"OEM": _STATE, "AEM": _QUATERNION}[kind]
    if kind == "AEM":
        is_angles = section.meta.get("ATTITUDE_TYPE", "").upper().startswith("EULER")
        names, section.meta["ATTITUDE_TYPE"] = (_ANGLES, "EULER_ANGLE") if is_angles else (_QUATERNION, "QUATERNION")
        section.meta["QUATERNION_TYPE"] = "LAST"  # by its name, QC is the scalar
    for record in data.findall("stateVector" if kind == "OEM" else "attitudeState"):
        row = len(section.rows) + 1
        section.rows.append((row, _epoch(path, row, record), _numbers(path, row, record, names)))
    return section


def _text(element: Element) -> str:
    return " ".join((element.text or "").split())


def _epoch(path: str | Path, row: int, record: Element) -> Instant:
    text = _text(next(record.iter("EPOCH"), Element("")))
    try:
        return parse_epoch([text])
    except InputError:
        fail(path, row, f"'{text}' is no epoch; expected one such as 2024-11-01T00:00:00")


def _numbers(path: str | Path, row: int, record: Element, names: tuple[str, ...]) -> list[float]:
    """Values of the named elements as far as there are any; InputError for other units than the standard's."""
    found = []
    for name in names:
        element = next(record.iter(name), None)
        if element is None:
            break
        unit = element.get("units", "")
        if name in _UNITS and unit.lower() not in ("", _UNITS[name]):
            fail(path, row, f"{name} is in {unit}, the standard has {_UNITS[name]}; export in it")
        found.append(number(_text(element), path, row, f"a number in <{name}>"))
    if names != _STATE and len(found) != len(names):
        fail(path, row, f"no {', '.join(names)} in this attitude; export quaternions or Euler angles")
    return found
