"""A command's options, read from the dataclass that it takes: tyro parses and explains it, completion lists it."""

import sys
from collections.abc import Callable, Iterator
from contextlib import redirect_stderr
from copy import copy
from dataclasses import dataclass, fields, is_dataclass, make_dataclass
from importlib import import_module
from io import StringIO
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

import tyro

from proxnav.cli.commands import Command
from proxnav.cli.options import WorkerOptions
from proxnav.errors import did_you_mean

_POSITIONAL = get_args(tyro.conf.Positional[int])[1]


@dataclass(frozen=True, slots=True)
class Option:
    """One option as it is typed."""

    flags: tuple[str, ...]
    """Its name and other words for it; of a switch also the name that turns it off."""
    values: tuple[str, ...]
    """What may follow it; empty where that is anything."""


def function_of(command: Command) -> Callable[[Any], None]:
    """The function that runs a command."""
    return import_module(f"proxnav.commands.{command.module}").run


def config_of(function: Callable[[Any], None]) -> type:
    """The dataclass that the function of a command takes."""
    return next(iter(get_type_hints(function).values()))


def parsed(kind: type, words: list[str], name: str) -> Any:
    """The configuration that the words of a command line ask for; wrong usage exits with 2."""
    said = StringIO()
    try:
        with redirect_stderr(said):
            config = tyro.cli(kind, args=words, prog=f"proxnav {name}")
    except SystemExit as stop:
        if stop.code:
            print(_misspelt(kind, words, name) or said.getvalue(), end="", file=sys.stderr)
        raise
    if isinstance(config, WorkerOptions):
        config.check()
    return config


def _misspelt(kind: type, words: list[str], name: str) -> str:
    """A line for the first word that is no option but nearly one; empty where there is none."""
    known = [flag for option in every_option(kind) for flag in option.flags]
    for word in words:
        flag = word.partition("=")[0].replace("_", "-")
        if flag.startswith("--") and flag not in known and (near := did_you_mean(flag, known)):
            return f"proxnav {name}: no option {flag}{near}\n"
    return ""


def folded(kind: type) -> type:
    """The dataclass with its nested ones left out of the help."""
    nested = [(f.name, tyro.conf.Suppress[f.type], copy(f)) for f in fields(kind) if is_dataclass(f.type)]
    short = make_dataclass(kind.__name__, nested, bases=(kind,), frozen=True)
    short.__doc__ = kind.__doc__
    return short


def nested_groups(kind: type, prefix: str = "--") -> Iterator[tuple[str, type]]:
    """(prefix of its options, type) of each dataclass below the fields of a dataclass."""
    for f in fields(kind):
        if is_dataclass(f.type):
            assert isinstance(f.type, type)
            below = f"{prefix}{_dashed(f.name)}."
            yield below, f.type
            yield from nested_groups(f.type, below)


def every_option(kind: type) -> Iterator[Option]:
    """The options of a dataclass and of those nested in it."""
    for prefix, part in [("--", kind), *nested_groups(kind)]:
        yield from own_options(part, prefix)


def own_options(kind: type, prefix: str = "--") -> Iterator[Option]:
    """The options of a dataclass without those nested in it."""
    for field_name, hint in get_type_hints(kind, include_extras=True).items():
        hint, *notes = get_args(hint) if get_origin(hint) is Annotated else (hint,)
        if _POSITIONAL in notes or any(map(is_dataclass, (hint, *get_args(hint)))):
            continue
        name = _dashed(next((note.name for note in notes if getattr(note, "name", None)), field_name))
        also = [alias for note in notes for alias in getattr(note, "aliases", None) or ()]
        flags = (prefix + name, f"{prefix}no-{name}") if hint is bool else (prefix + name, *also)
        yield Option(flags, tuple(_choices(hint)))


def _dashed(name: str) -> str:
    return name.replace("_", "-")


def _choices(hint: Any) -> Iterator[str]:
    """The words of every Literal in a type."""
    if get_origin(hint) is Literal:
        yield from map(str, get_args(hint))
        return
    for part in get_args(hint):
        yield from _choices(part)
