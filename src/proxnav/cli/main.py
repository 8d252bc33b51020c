"""The command line: finds the command's module and hands over; nothing else is imported before that."""

import os
import sys
from collections.abc import Callable
from importlib import import_module

from proxnav.cli.commands import COMMANDS
from proxnav.cli.help_pages import FULL, captured, folded

_RESUMABLE = {"demo", "render", "train", "benchmark", "setup"}


def main(argv: list[str] | None = None) -> int:
    """Runs `proxnav COMMAND ...` and returns the exit status: 0 done, 1 bad input, 2 wrong usage, 130 interrupted."""
    argv = sys.argv[1:] if argv is None else argv
    if not argv or argv[0] in ("-h", "--help"):
        print(_overview())
        return 0
    if argv[0] == "--version":
        from proxnav import __version__

        print(f"proxnav {__version__}")
        return 0
    if argv[0] not in COMMANDS:
        print(f"proxnav: unknown command '{argv[0]}'; one of {', '.join(COMMANDS)}", file=sys.stderr)
        return 2
    return _run(argv[0], argv[1:])


def _run(command: str, argv: list[str]) -> int:
    from proxnav.errors import InputError

    try:
        _call(command, argv)
    except InputError as error:
        print(f"proxnav {command}: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        resumes = "; the same command resumes it" if command in _RESUMABLE else ""
        print(f"proxnav {command}: interrupted{resumes}", file=sys.stderr)
        return 130
    except BrokenPipeError:  # the reader of our output, such as `head`, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        if error.filename is None:
            raise
        reason = f"{error.filename}: {error.strerror}; check the path and its permissions"
        print(f"proxnav {command}: {reason}", file=sys.stderr)
        return 1
    return 0


def _call(command: str, argv: list[str]) -> None:
    """Hands over; words that are URLs become folders here while the command runs."""
    run = import_module(f"proxnav.commands.{command}").main
    if {"-h", "--help", FULL} & set(argv):
        return _explain(run, command, argv)
    if not any("://" in word for word in argv):
        return run(argv)
    from proxnav.cli.remote import localised

    with localised(argv) as words:
        return run(words)


def _explain(run: Callable[[list[str]], None], command: str, argv: list[str]) -> None:
    """The command's help, one screen of it unless all of it is asked for."""
    page = captured(run, [word for word in argv if word not in ("-h", "--help", FULL)])
    name = " ".join([command, *(word for word in argv[:1] if not word.startswith("-"))])
    print(page if FULL in argv else folded(page, name), end="")


def _overview() -> str:
    width = max(map(len, COMMANDS))
    rows = "\n".join(f"  {name:<{width}}  {job}" for name, job in COMMANDS.items())
    return (
        "usage: proxnav COMMAND [options]\n\nRelative navigation of spacecraft from one camera.\n\n"
        f"{rows}\n\n'proxnav COMMAND --help' explains one. Exit status: 0 done, 1 bad input, 2 wrong usage, "
        "130 interrupted."
    )


if __name__ == "__main__":
    sys.exit(main())
