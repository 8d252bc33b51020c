"""What STK's `.e` and `.a` files share: banner, keywords, blocks of data rows, checks against truncation."""

import re
import warnings
from dataclasses import dataclass
from pathlib import Path

from proxnav.errors import InputError, InputNote
from proxnav.geometry.epochs import Instant
from proxnav.trajectories.readers.dates import from_gmat_mjd, parse_date
from proxnav.trajectories.readers.reference_frames import ORBITAL, ReferenceFrame, frame_kind
from proxnav.trajectories.readers.text import fail, number, read_lines

_BANNER = re.compile(r"stk\.v\.\d+(\.\d+)*", re.IGNORECASE)
_FLAGS = {"begin", "end"}


@dataclass(frozen=True, slots=True)
class Row:
    """One line of data."""

    line: int
    tokens: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class StkFile:
    """Keywords (lower case) with their line and value, and the rows of each data block."""

    path: str
    keywords: dict[str, tuple[int, str]]
    blocks: dict[str, list[Row]]

    def text(self, keyword: str, default: str) -> str:
        """Value of a keyword; keywords are given in lower case."""
        return self.keywords.get(keyword, (0, default))[1]

    def integer(self, keyword: str, default: int) -> int:
        """Value of a counting keyword."""
        line, value = self.keywords.get(keyword, (0, str(default)))
        count = number(value, self.path, line, f"a whole number after {keyword}")
        if count < 0 or count != int(count):
            fail(self.path, line, f"{keyword} needs a whole number, found '{value}'; mend the line")
        return int(count)


def read_stk(path: str | Path, kind: str, data_blocks: set[str]) -> StkFile:
    """The file with its `BEGIN kind ... END kind` read into keywords and blocks."""
    lines = read_lines(path)
    _check_frame(str(path), lines, kind)
    file = StkFile(str(path), {}, {})
    block = ""
    for count, line in enumerate(lines, start=1):
        tokens = line.split("#", 1)[0].split()
        if not tokens or _BANNER.fullmatch(tokens[0]):
            continue
        word = tokens[0].lower()
        if word in _FLAGS:
            block = tokens[1].lower() if word == "begin" and len(tokens) > 1 and tokens[1].lower() != kind else ""
        elif word in data_blocks or word.startswith("covariance"):
            block = word
            file.blocks[block] = []
        elif block:  # nothing but data stands between a block's name and its end
            file.blocks.setdefault(block, []).append(Row(count, tuple(tokens)))
        elif word[0].isalpha():
            file.keywords[word] = (count, line.split("#", 1)[0].strip()[len(tokens[0]) :].strip())
        else:
            fail(path, count, f"numbers outside a data block; one of {', '.join(sorted(data_blocks))} must come first")
    return file


def data_rows(file: StkFile, data_blocks: set[str], count_keyword: str) -> tuple[str, list[Row]]:
    """(block name, rows), cut at the declared count as STK does.

    A file with fewer rows is whole, because its END is there: a note says so.
    """
    found = [name for name in file.blocks if name in data_blocks]
    if len(found) != 1:
        raise InputError(
            f"{file.path}: expected one data block, found {', '.join(found) or 'none'}; known blocks are "
            f"{', '.join(sorted(data_blocks))}"
        )
    rows = file.blocks[found[0]]
    declared = file.integer(count_keyword, len(rows))
    if not rows or declared < 1:
        raise InputError(f"{file.path}: {count_keyword} says {declared} points, found {len(rows)}; export it again")
    if len(rows) != declared:
        what = (
            f"the {len(rows) - declared} rows after that are ignored"
            if len(rows) > declared
            else (f"the {len(rows)} rows that there are before END are read")
        )
        warnings.warn(f"{file.path}: {count_keyword} is {declared}, {what}", InputNote, stacklevel=2)
    return found[0], rows[:declared]


def scenario_epoch(file: StkFile) -> Instant:
    """ScenarioEpoch, quoted or not; a bare number is GMAT's modified Julian date."""
    if "scenarioepoch" not in file.keywords:
        raise InputError(f"{file.path}: ScenarioEpoch is missing; add a line such as ScenarioEpoch 1 Nov 2024 00:00:00")
    return _epoch(file, "scenarioepoch")


def reference_frame(file: StkFile, keyword: str, default: str) -> ReferenceFrame:
    """The frame that a keyword names; `<keyword>epoch` freezes of-epoch frames."""
    body = file.text("centralbody", "Earth")
    if body.lower() != "earth":
        line = file.keywords["centralbody"][0]
        fail(file.path, line, f"CentralBody is {body}, only Earth is supported; export about Earth")
    name = file.text(keyword, default).strip("\"'")
    kind = "ric" if name.lower().startswith("lvlh") else frame_kind(name)  # STK's LVLH has x outward, its VVLH z nadir
    if kind is None or (kind in ORBITAL and keyword == "coordinatesystem"):
        line = file.keywords[keyword][0]
        fail(file.path, line, f"unknown {keyword} '{name}'; export in ICRF, J2000, Fixed, TEMEOfDate or MeanOfDate")
    is_frozen = ReferenceFrame(kind).is_frozen
    if is_frozen and f"{keyword}epoch" not in file.keywords:
        raise InputError(f"{file.path}: {name} needs the keyword {keyword}epoch; add it or export in ICRF")
    return ReferenceFrame(kind, _epoch(file, f"{keyword}epoch") if is_frozen else None)


def _epoch(file: StkFile, keyword: str) -> Instant:
    line, value = file.keywords[keyword]
    try:
        return from_gmat_mjd(float(value))
    except ValueError:
        pass
    try:
        return parse_date(value)
    except InputError as error:
        fail(file.path, line, f"{error}")


def _check_frame(path: str, lines: list[str], kind: str) -> None:
    first = next((line for line in lines if line.strip() and not line.lstrip().startswith("#")), "")
    if not _BANNER.fullmatch(first.strip()):
        raise InputError(f"{path}, line 1: expected the banner stk.v.<number>, found '{first.strip()[:40]}'")
    words = [line.lower().split() for line in lines]
    for flag in ("begin", "end"):
        if [flag, kind] not in [found[:2] for found in words]:
            hint = "the file is cut off; export it again" if flag == "end" else f"it is no STK {kind} file"
            raise InputError(f"{path}: {flag.upper()} {kind.capitalize()} is missing: {hint}")
