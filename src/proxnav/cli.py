"""The command line: finds the command's module and hands over; nothing else is imported before that."""

import os
import sys
from importlib import import_module

COMMANDS = {
    "demo": "the whole chain, small: render, estimate, solve, evaluate, plot",
    "render": "a data set or a sequence, from a preset or a trajectory file",
    "train": "a keypoint detector, from a data set or rendered on line",
    "estimate": "images or a data set to poses.json",
    "solve": "keypoints of your own detector to poses.json",
    "simulate": "sensor records along a trajectory: camera, gyro, star tracker, GNSS",
    "navigate": "the filter over records: navigation solution with covariance",
    "evaluate": "poses.json against truth: the study's Table 1 and ours",
    "report": "one HTML page of a finished run",
    "target": "look at a target: keypoints, extents, preview",
    "convert": "data sets, poses and trajectories between formats",
    "benchmark": "measured tables beside their references",
    "setup": "install what proxnav cannot bring itself: blender",
}

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
        import_module(f"proxnav.commands.{command}").main(argv)
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


def _overview() -> str:
    width = max(map(len, COMMANDS))
    rows = "\n".join(f"  {name:<{width}}  {job}" for name, job in COMMANDS.items())
    return (
        "usage: proxnav COMMAND [options]\n\nRelative navigation of spacecraft from one camera.\n\n"
        f"{rows}\n\n'proxnav COMMAND --help' lists a command's options. Exit status: 0 done, 1 bad input, "
        "2 wrong usage, 130 interrupted."
    )


if __name__ == "__main__":
    sys.exit(main())
