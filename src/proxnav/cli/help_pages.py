"""Help that fits a screen: a command's own options; nested groups are named and shown with --help-all."""

import io
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import redirect_stdout

FULL = "--help-all"
_HEAD = re.compile(r"╭─ (?P<title>.*?) ─*╮$")
_OWN = ("positional arguments", "options", "subcommands")
_DETAIL = re.compile(r"│ (─+|      .*) │")
_OPTION = re.compile(r"^│ (--|-h|\[--)")


def captured(run: Callable[[list[str]], None], argv: list[str]) -> str:
    """The help of a command, in what the terminal can show; frames need a terminal that knows UTF-8."""
    buffer = io.BytesIO()
    page = io.TextIOWrapper(buffer, encoding="utf-8", write_through=True)
    try:
        with redirect_stdout(page):
            run([*argv, "--help"])
    except SystemExit as stopped:
        if stopped.code not in (0, None):
            raise
    shown = sys.stdout.encoding or "utf-8"
    return buffer.getvalue().decode().encode(shown, "replace").decode(shown)


def folded(page: str, command: str) -> str:
    """The page with groups such as `reader options` as one line each; unchanged where it has none."""
    kept: list[str] = []
    groups: list[str] = []
    for title, lines in _panels(page):
        if title == "subcommands":  # their names alone; what they are is said with --help-all
            kept += [line for line in lines if not _DETAIL.fullmatch(line)]
        elif title is None or title in _OWN:
            kept += lines
        else:
            count = sum(bool(_OPTION.match(line)) for line in lines)
            groups.append(f"--{title.removesuffix(' options')}.* ({count})")
    if not groups:
        return page
    return "\n".join([*kept, "", f"further options, shown by 'proxnav {command} {FULL}': {', '.join(groups)}", ""])


def _panels(page: str) -> Iterator[tuple[str | None, list[str]]]:
    """(title, lines) of each framed group; None for lines between them."""
    lines: list[str] = []
    title = None
    for line in page.rstrip("\n").splitlines():
        head = _HEAD.match(line)
        if head:
            yield title, lines
            title, lines = head["title"], []
        lines.append(line)
        if line.startswith("╰"):
            yield title, lines
            title, lines = None, []
    yield title, lines
