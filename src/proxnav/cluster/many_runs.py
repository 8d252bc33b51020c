"""Many independent runs of one command, each in a folder of its own: finished ones are kept, wherever they are made."""

from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from proxnav.cluster.carried import Carried
from proxnav.cluster.jobs import run_anywhere
from proxnav.cluster.progress import Progress, silent
from proxnav.errors import InputError
from proxnav.storage.files import inside, read_json, write_atomic, write_json
from proxnav.storage.lock import only_run_in
from proxnav.storage.run_record import plain, run_record

NamedRun = tuple[str, Any]
"""Name of a run, which is its folder's, and what the run is made of."""
_MAY_DIFFER = ("out", "records", "runs", "workers", "on")


def run_many(
    command: str, make_job: Callable[[], Callable[[NamedRun], Carried]], runs: Sequence[NamedRun], options: Any,
    last: str, send: Callable[[NamedRun], NamedRun] | None = None, progress: Progress = silent,
) -> None:  # fmt: skip
    """Each run's files in `options.out / name`, the file `last` at the end: a run that has it is kept.

    `options` is the command's dataclass, kept as COMMAND.json; InputError where the folder holds runs of other ones.
    """
    out: Path = options.out
    with only_run_in(out):
        _check_options(out / f"{command}.json", options)
        waiting = [run for run in runs if not (out / run[0] / last).is_file()]
        with progress(command, len(waiting)) as done:
            for (name, _), carried in run_anywhere(make_job, waiting, options.workers, options.on, _name, send):
                for file in sorted(carried.files, key=lambda file: (file == last, file)):
                    write_atomic(inside(out / name, file), carried.files[file])
                done()


def files_of(write: Callable[[Path], object]) -> Carried:
    """What a function writes into a folder."""
    with TemporaryDirectory() as folder:
        write(Path(folder))
        return Carried.of(Path(folder))


def _name(run: NamedRun) -> str:
    return run[0]


def _check_options(path: Path, options: Any) -> None:
    now = {name: value for name, value in plain(options).items() if name not in _MAY_DIFFER}
    if path.is_file():
        before = read_json(path, "the options of the runs in this folder")["options"]
        other = [name for name, value in now.items() if before.get(name) != value]
        if other:
            raise InputError(f"{path.parent}: its runs were made with another {other[0]}; give another --out")
    write_json(path, run_record(options), indent=1)
