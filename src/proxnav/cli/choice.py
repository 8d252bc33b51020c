"""Commands whose first word chooses among several: `proxnav train heatmap`, `proxnav benchmark table1`."""

from collections.abc import Mapping
from importlib import import_module

from proxnav.errors import InputError

Choices = Mapping[str, tuple[str, str, str]]
"""Word to (module of proxnav.commands, its entry, what it does)."""


def choose(argv: list[str], command: str, choices: Choices) -> None:
    """Runs the chosen entry with the rest of the words; without one, or with --help, lists them."""
    if not argv or argv[0] in ("-h", "--help"):
        width = max(map(len, choices))
        rows = "\n".join(f"  {name:<{width}}  {job}" for name, (_, _, job) in choices.items())
        print(
            f"usage: proxnav {command} WHICH [options]\n\n{rows}\n\n'proxnav {command} WHICH --help' lists its options."
        )
        return
    if argv[0] not in choices:
        raise InputError(f"'{argv[0]}' is not one of {', '.join(choices)}")
    module, entry, _ = choices[argv[0]]
    getattr(import_module(f"proxnav.commands.{module}"), entry)(argv[1:])
