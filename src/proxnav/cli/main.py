"""The command line: finds the command's function and hands its options over; nothing else is imported before that."""

import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from proxnav.cli.commands import COMMANDS, Command, Group

_HELP = {"-h", "--help"}
_RESUMABLE = {"demo", "learn", "render", "train", "benchmark", "setup"}
_EXTRAS = dict.fromkeys(("torch", "torchvision", "lightning", "lightning_fabric", "onnx"), "train")
"""What is imported without being caught where it is used, and the extra that brings it."""


def main(argv: list[str] | None = None) -> int:
    """Runs `proxnav COMMAND ...` and returns the exit status.

    0 done, 1 bad input, 2 wrong usage, 3 done but not to be trusted, 130 interrupted.
    """
    argv = sys.argv[1:] if argv is None else argv
    if not argv or argv[0] in _HELP:
        print(_overview())
        return 0
    if argv[0] == "--version":
        from proxnav import __version__

        print(f"proxnav {__version__}")
        return 0
    if argv[0] not in COMMANDS:
        from proxnav.errors import did_you_mean

        near = did_you_mean(argv[0], COMMANDS)
        print(f"proxnav: unknown command '{argv[0]}'{near or '; one of ' + ', '.join(COMMANDS)}", file=sys.stderr)
        return 2
    return _run(argv[0], argv[1:])


def console() -> int:
    """`main` for the shell: after Ctrl-C, when all is saved, no worker is waited for.

    Python would first let them finish what they draw, a minute or more, of which nothing is kept.
    """
    status = main()
    if status == 130 and "multiprocessing" in sys.modules:
        for worker in sys.modules["multiprocessing"].active_children():
            worker.terminate()
    return status


def _run(name: str, argv: list[str]) -> int:
    from proxnav.errors import InputError

    try:
        with _notes_in_a_line(name):
            return _choose(name, argv)
    except InputError as error:
        print(f"proxnav {name}: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        resumes = "; the same command resumes it" if name in _RESUMABLE else ""
        print(f"proxnav {name}: interrupted{resumes}", file=sys.stderr)
        return 130
    except BrokenPipeError:  # the reader of our output, such as `head`, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        if error.filename is None:
            raise
        reason = f"{error.filename}: {error.strerror}; check the path and its permissions"
        print(f"proxnav {name}: {reason}", file=sys.stderr)
        return 1
    except ModuleNotFoundError as error:
        if error.name not in _EXTRAS:
            raise
        print(f"proxnav {name}: needs {error.name}: pip install 'proxnav[{_EXTRAS[error.name]}]'", file=sys.stderr)
        return 1
    return 0


@contextmanager
def _notes_in_a_line(name: str) -> Iterator[None]:
    """Within it, an `InputNote` is one line on stderr; other warnings keep their form."""
    import warnings

    from proxnav.errors import InputNote

    as_ever = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *where: Any) -> None:
        if issubclass(category, InputNote):
            print(f"proxnav {name}: note: {message}", file=sys.stderr)
        else:
            as_ever(message, category, *where)

    with warnings.catch_warnings():
        warnings.simplefilter("always", InputNote)
        warnings.showwarning = show
        yield


def _choose(name: str, argv: list[str]) -> int:
    """Exit status of the command, or of the one of its group that the next word names."""
    from proxnav.errors import InputError, did_you_mean

    entry = COMMANDS[name]
    if isinstance(entry, Command):
        return _call(entry, name, argv)
    if not argv or argv[0] in _HELP:
        print(_group_overview(name, entry))
    elif argv[0] not in entry.commands:
        near = did_you_mean(argv[0], entry.commands)
        raise InputError(f"'{argv[0]}' is not one of {', '.join(entry.commands)}{near}")
    else:
        return _call(entry.commands[argv[0]], f"{name} {argv[0]}", argv[1:])
    return 0


def _call(command: Command, name: str, argv: list[str]) -> int:
    """Hands over; words that are URLs become folders here while the command runs."""
    from proxnav.cli.help_pages import FULL, explain
    from proxnav.cli.parser import config_of, function_of, parsed

    function = function_of(command)
    kind = config_of(function)
    if {*_HELP, FULL} & set(argv):
        explain(kind, name, FULL in argv)
        return 0
    _refuse_renamed(command, argv)
    _refuse_both(argv)
    if not any("://" in word for word in argv):
        return function(parsed(kind, argv, name)) or 0
    from proxnav.cli.remote import localised

    with localised(argv) as words:
        return function(parsed(kind, words, name)) or 0


def _refuse_renamed(command: Command, argv: list[str]) -> None:
    from proxnav.errors import InputError

    for former, present in command.renamed.items():
        if any(word == former or word.startswith((f"{former}=", f"{former}.")) for word in argv):
            raise InputError(f"{former} is now {present}")


def _refuse_both(argv: list[str]) -> None:
    """--preset is another word for --mission: one command line has one mission."""
    from proxnav.errors import InputError

    given = [word.split("=")[0] for word in argv]
    if "--mission" in given and "--preset" in given:
        raise InputError("--mission and --preset are two words for one thing; give one of them")


def _overview() -> str:
    return (
        "usage: proxnav COMMAND [options]: relative navigation of spacecraft from one camera.\n\n"
        f"{_table(COMMANDS)}\n\n'proxnav COMMAND --help' explains one. Exit status: 0 done, 1 bad input, "
        "2 wrong usage, 3 done but not to be trusted, 130 interrupted."
    )


def _group_overview(name: str, group: Group) -> str:
    return (
        f"usage: proxnav {name} WHICH [options]\n\n{_table(group.commands)}\n\n"
        f"'proxnav {name} WHICH --help' lists the options of one."
    )


def _table(entries: Mapping[str, Command | Group]) -> str:
    width = max(map(len, entries))
    return "\n".join(f"  {name:<{width}}  {entry.job}" for name, entry in entries.items())


if __name__ == "__main__":
    sys.exit(main())
