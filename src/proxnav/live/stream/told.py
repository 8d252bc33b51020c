"""Answers as JSON lines, csv rows, or MCAP messages, written as they come."""

import csv
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import Camera, quaternion
from proxnav.live.stream.answers import Answer
from proxnav.live.stream.loop import Tell
from proxnav.records import NavState
from proxnav.storage.files import finite
from proxnav.viewing.live_mcap import LiveMcap

_POSE = (*(f"q_cam_target_{c}" for c in "wxyz"), *(f"t_cam_target_{c}_m" for c in "xyz"))
_SIGMAS = tuple(f"sigma_{name}" for name in ("x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"))
_STATE = (*(f"r_ric_{c}_m" for c in "xyz"), *(f"v_ric_{c}_mps" for c in "xyz"))
COLUMNS = ("name", "t_s", "status", "latency_s", *_POSE, *_SIGMAS, "nav_status", *_STATE)
"""Header of a csv file; a field that is not known is empty."""


@contextmanager
def told_to(path: Path, camera: Camera) -> Iterator[Tell]:
    """A file that grows by each answer: .jsonl, .csv or .mcap; complete at any moment but for MCAP's index."""
    suffix = path.suffix.lower()
    if suffix == ".mcap":
        with LiveMcap.into(path, camera) as mcap:
            yield lambda answer, image: mcap.write(
                answer.t, image, answer.result.T_cam_target, answer.result.covariance, answer.state
            )
        return
    if suffix not in (".jsonl", ".csv"):
        raise InputError(f"{path}: answers are written as .jsonl, .csv or .mcap")
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="" if suffix == ".csv" else None, encoding="utf-8") as file:
        yield csv_rows(file) if suffix == ".csv" else json_lines(file)


def json_lines(file: TextIO) -> Tell:
    """Each answer as one line of JSON."""

    def tell(answer: Answer, _: Any) -> None:
        file.write(json.dumps(finite(entry(answer))) + "\n")
        file.flush()

    return tell


def csv_rows(file: TextIO) -> Tell:
    """A header, then each answer as a row."""
    writer = csv.DictWriter(file, COLUMNS)
    writer.writeheader()

    def tell(answer: Answer, _: Any) -> None:
        writer.writerow(_row(answer))
        file.flush()

    return tell


def entry(answer: Answer) -> dict[str, Any]:
    """An answer as a JSON object; q is scalar first, w not negative."""
    T, P = answer.result.T_cam_target, answer.result.covariance
    found: dict[str, Any] = {
        "name": answer.name, "t": answer.t, "status": answer.result.status,
        "q_cam_target": None if T is None else quaternion.canonical(T.q_wxyz).tolist(),
        "t_cam_target_m": None if T is None else T.t_m.tolist(),
        "covariance": None if P is None else P.tolist(), "latency_s": answer.latency_s,
    }  # fmt: skip
    return found if answer.state is None else found | {"navigation": _state(answer.state)}


def _state(state: NavState) -> Mapping[str, Any]:
    return {
        "status": state.status, "t": state.t, "r_ric_m": state.r_ric_m.tolist(), "v_ric_mps": state.v_ric_mps.tolist(),
        "q_cam_target": quaternion.canonical(state.q_cam_target).tolist(),
        "t_cam_target_m": state.t_cam_target_m.tolist(), "rate_target_radps": state.rate_target.tolist(),
        "sigma": np.sqrt(np.diag(state.covariance)).tolist(), "cause": state.cause,
    }  # fmt: skip


def _row(answer: Answer) -> dict[str, Any]:
    T, P, state = answer.result.T_cam_target, answer.result.covariance, answer.state
    row: dict[str, Any] = {"name": answer.name, "t_s": f"{answer.t:.6f}", "status": answer.result.status,
                           "latency_s": f"{answer.latency_s:.4f}"}  # fmt: skip
    if T is not None:
        row |= dict(zip(_POSE, (*quaternion.canonical(T.q_wxyz), *T.t_m), strict=True))
    if P is not None:
        row |= dict(zip(_SIGMAS, np.sqrt(np.diag(P)), strict=True))
    if state is not None:
        row |= dict(zip(_STATE, (*state.r_ric_m, *state.v_ric_mps), strict=True)) | {"nav_status": state.status}
    return row
