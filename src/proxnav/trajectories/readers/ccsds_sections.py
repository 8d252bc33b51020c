"""What CCSDS messages are made of, whatever their spelling: META sections, their data rows, checks of both; and KVN."""

import re
from dataclasses import dataclass, field
from pathlib import Path

from proxnav.errors import InputError
from proxnav.geometry.epochs import Instant, parse_iso
from proxnav.trajectories.readers.text import fail, number, read_lines
from proxnav.trajectories.time_systems import TimeSystem, time_system

_KEYWORD = re.compile(r"([A-Z0-9_]+)\s*=\s*(.*)")


@dataclass(slots=True)
class MetaSection:
    """One META section and the rows that follow it."""

    line: int
    version: str
    """Version of the message."""
    meta: dict[str, str] = field(default_factory=dict)
    rows: list[tuple[int, Instant, list[float]]] = field(default_factory=list)
    """(line, epoch in the section's own time system, numbers)."""
    covariances: int = 0
    """Covariance matrices, which nothing here uses."""

    @property
    def time_system(self) -> TimeSystem:
        """Time system of the section's epochs; `checked` has seen that it is a known one."""
        system = time_system(self.meta.get("TIME_SYSTEM", "UTC"))
        assert system is not None
        return system


def need(path: str | Path, section: MetaSection, keyword: str) -> str:
    """Value of a keyword; InputError where the section lacks it."""
    if keyword not in section.meta:
        fail(path, section.line, f"{keyword} is missing in this META section; add it")
    return section.meta[keyword]


def read_kvn(path: str | Path, kind: str) -> list[MetaSection]:
    """Sections of a message in keyword = value notation; `kind` is OEM or AEM."""
    sections: list[MetaSection] = []
    version, inside = "", ""
    for count, raw in enumerate(read_lines(path), start=1):
        line = raw.strip()
        if not line or line.startswith("COMMENT"):
            continue
        if line.endswith("_START") or line.endswith("_STOP"):
            inside = _enter(path, count, line, inside, sections, version)
        elif match := _KEYWORD.fullmatch(line):
            if match[1] in (f"CCSDS_{kind}_VERS", f"CIC_{kind}_VERS"):
                version = match[2].strip()
            elif inside == "META":
                sections[-1].meta[match[1]] = match[2].strip()
            elif inside == "COVARIANCE" and match[1] == "EPOCH" and sections:
                sections[-1].covariances += 1
        elif inside not in ("META", "COVARIANCE"):
            if not sections:
                fail(path, count, "data before the first META section; the file's head is missing")
            sections[-1].rows.append(_row(path, count, line.split()))
    if not version:
        raise InputError(f"{path}: CCSDS_{kind}_VERS is missing: it is no {kind} file in KVN")
    if inside or not sections:
        raise InputError(f"{path}: {inside or 'META'}_{'STOP' if inside else 'START'} is missing: the file is cut off")
    return sections


def checked(path: str | Path, sections: list[MetaSection]) -> list[MetaSection]:
    """The sections; InputError for time systems and central bodies that are not read, and for sections without rows."""
    for section in sections:
        system = section.meta.get("TIME_SYSTEM", "UTC")
        if time_system(system) is None:
            fail(path, section.line, f"TIME_SYSTEM is {system}, read are UTC, TAI, GPS, TT and TDB; export in UTC")
        if section.meta.get("CENTER_NAME", "EARTH").upper() not in ("EARTH", "EARTH BARYCENTER", "399"):
            fail(path, section.line, f"CENTER_NAME is {section.meta['CENTER_NAME']}, only EARTH is supported")
        if not section.rows:
            fail(path, section.line, "no data rows follow this META section; the file is cut off")
    return sections


def parse_epoch(tokens: list[str]) -> Instant:
    """ISO 8601, or the CIC variants' MJD and seconds of the day."""
    if len(tokens) == 2:
        return Instant(int(tokens[0]), 0.0).plus(float(tokens[1]))
    return parse_iso(tokens[0])


def _enter(path: str | Path, count: int, line: str, inside: str, sections: list[MetaSection], version: str) -> str:
    name, _, flag = line.rpartition("_")
    if flag == "STOP":
        if name != inside:
            fail(path, count, f"{line} without {name}_START; the file is damaged")
        return ""
    if inside:
        fail(path, count, f"{line} before {inside}_STOP; the file is damaged")
    if name == "META":
        sections.append(MetaSection(count, version))
    return name


def _row(path: str | Path, count: int, tokens: list[str]) -> tuple[int, Instant, list[float]]:
    width = 2 if re.fullmatch(r"\d{5}", tokens[0]) else 1  # CIC: MJD and seconds of the day
    try:
        moment = parse_epoch(tokens[:width])
    except (InputError, ValueError):
        fail(path, count, f"'{' '.join(tokens[:width])}' is no epoch; expected one such as 2024-11-01T00:00:00")
    return count, moment, [number(token, path, count) for token in tokens[width:]]
