"""Results of single Monte Carlo runs on disk, so that a long benchmark can be interrupted."""

import hashlib
import io
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from proxnav.benchmarks.monte_carlo import Job, RunResult
from proxnav.storage.files import write_atomic

_SERIES = ("range_m", "errors", "sigmas", "nees", "status")


def fingerprint(job: Job) -> str:
    """Tells runs of the same options from others."""
    return hashlib.sha256(json.dumps(job.options, sort_keys=True, default=str).encode()).hexdigest()


def write_runs(path: Path, results: Mapping[int, RunResult], mark: str) -> None:
    """All runs in one npz file, by seed."""
    arrays: dict[str, np.ndarray] = {"mark": np.array(mark)}
    for seed, result in results.items():
        arrays |= {f"{seed}/{name}": getattr(result, name) for name in _SERIES}
        rest = {"nis": result.nis, "single": [result.single_position_m, result.single_attitude_rad],
                "starts": result.starts}  # fmt: skip
        arrays[f"{seed}/rest"] = np.array(json.dumps(rest))
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)  # type: ignore[arg-type]
    write_atomic(path, buffer.getvalue())


def read_runs(path: Path, mark: str) -> dict[int, RunResult]:
    """Inverse of `write_runs`; nothing when the file is missing or belongs to other options."""
    if not path.is_file():
        return {}
    with np.load(path, allow_pickle=False) as stored:
        if str(stored["mark"]) != mark:
            return {}
        seeds = sorted({int(name.split("/")[0]) for name in stored.files if "/" in name})
        return {seed: _result({name: stored[f"{seed}/{name}"] for name in (*_SERIES, "rest")}) for seed in seeds}


def _result(stored: Mapping[str, np.ndarray]) -> RunResult:
    rest = json.loads(str(stored["rest"]))
    nis = {kind: (float(value), int(count)) for kind, (value, count) in rest["nis"].items()}
    position, attitude = rest["single"]
    series = {name: stored[name] for name in _SERIES}
    return RunResult(**series, nis=nis, single_position_m=position, single_attitude_rad=attitude, starts=rest["starts"])
