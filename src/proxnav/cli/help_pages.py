"""Help that fits a screen: a command's own options; nested groups are named and shown with --help-all."""

import sys
from contextlib import suppress
from io import TextIOWrapper

from proxnav.cli.parser import folded, nested_groups, own_options, parsed

FULL = "--help-all"


def explain(kind: type, name: str, is_full: bool) -> None:
    """Prints the help of the command `name`, whose options are those of the dataclass `kind`."""
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # not every terminal knows every letter
    with suppress(SystemExit):
        parsed(kind if is_full else folded(kind), ["--help"], name)
    groups = [f"{prefix}* ({len(list(own_options(part)))})" for prefix, part in nested_groups(kind)]
    if groups and not is_full:
        print(f"\nfurther options, shown by 'proxnav {name} {FULL}': {', '.join(groups)}")
