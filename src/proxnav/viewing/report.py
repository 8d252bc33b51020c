"""One HTML file that shows a run: numbers beside the study, errors against range, calibration, frames, overlays.

The file needs no network: style, script and pictures are inside. Text from files is escaped, and the page forbids
every script but its own, so a file name that holds markup stays a file name.
"""

import base64
import hashlib
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.evaluation.error_tables import HEADLINE, STUDY
from proxnav.evaluation.pairing import PairedFrame, from_best_to_worst
from proxnav.evaluation.run_folder import Picture, Run, read_run
from proxnav.geometry.pose_errors import HALF_TURN_RAD
from proxnav.images.codecs import encode_jpeg, read_image
from proxnav.viewing.number_text import number
from proxnav.viewing.report_charts import calibration, phase_charts, range_charts, stanford_charts
from proxnav.viewing.report_filter import filter_section

_PICTURES = 150
_PICTURE_BYTES = 8_000_000  # of all pictures together; base64 adds a third
_SIZES = ((1024, 85), (1024, 70), (768, 70), (512, 70), (384, 60), (256, 50))  # longer side [px], JPEG quality
_PAGE = Path(__file__).parent / "page"


def report_html(folder: Path, title: str) -> str:
    """The report of the run in `folder`: estimates (poses.json, truth.json, metrics.json; overlays/, frames.json and
    config.json where they are there), a navigation solution (solution.csv), or both.
    """
    run = read_run(folder)
    pages = Environment(
        loader=FileSystemLoader(_PAGE), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    style, script = (_text("report.css"), _text("report.js"))
    return pages.get_template("report.html").render(
        title=title,
        style=Markup(style),
        script=Markup(script),
        style_hash=_hash(style),
        script_hash=_hash(script),
        headline=list(headline(run.metrics)),
        coverage=coverage(run.frames),
        range_charts=[Markup(chart) for chart in range_charts(run)],
        phase_charts=[Markup(chart) for chart in phase_charts(run)],
        stanford=[Markup(chart) for chart in stanford_charts(run)],
        has_bound=bool(run.notes),
        calibration=calibration(run),
        filter=filter_section(run.solution),
        frames=[_frame_cells(frame, run) for frame in run.frames],
        statuses=sorted({frame.status for frame in run.frames}),
        gallery=list(_gallery(run)),
        hidden=max(0, len(run.pictures) - _PICTURES),
        found=[_found_cells(record) for record in run.found],
        config=list(flattened(run.config)),
    )


def headline(metrics: Mapping[str, Any]) -> Iterator[dict[str, str]]:
    """Rows of the headline table: label, unit, study, ours, 95 % interval; a dash where there is no number."""
    axes = metrics.get("mean_e_t_m")
    values = dict(metrics)
    if isinstance(axes, list) and len(axes) == 3:
        values |= dict(zip(list(HEADLINE)[:3], axes, strict=True))
    intervals = metrics.get("intervals")
    for key, (label, unit) in HEADLINE.items():
        low, high = _pair(intervals.get(key) if isinstance(intervals, dict) else None)
        yield {
            "label": label,
            "unit": unit,
            "study": number(STUDY.get(key)),
            "ours": number(values.get(key)),
            "interval": "–" if low == "–" else f"{low} to {high}",
        }


def coverage(frames: tuple[PairedFrame, ...]) -> dict[str, str]:
    """How many frames have a pose, why the others have none, how many poses are turned by more than 90 deg."""
    without = [frame.status for frame in frames if frame.errors is None]
    turned = sum(frame.errors.e_r_rad > HALF_TURN_RAD for frame in frames if frame.errors is not None)
    reasons = ", ".join(f"{without.count(status)} {status}" for status in sorted(set(without)))
    return {
        "frames": str(len(frames)),
        "poses": str(len(frames) - len(without)),
        "without a pose": f"{len(without)} ({reasons})" if without else "0",
        "half turns (E_R > 90 deg)": str(turned),
    }


def flattened(config: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """(dotted name, value) of every leaf of a nested configuration."""
    if isinstance(config, Mapping) and config:
        for key, value in config.items():
            yield from flattened(value, f"{path}.{key}" if path else str(key))
    elif config is not None or path:
        yield path, ", ".join(map(str, config)) if isinstance(config, list) else str(config)


def _frame_cells(frame: PairedFrame, run: Run) -> dict[str, Any]:
    """Texts and sort keys of one row of the table of frames."""
    e, note = frame.errors, run.notes.get(frame.filename)
    numbers = [frame.range_m, None if note is None else math.degrees(note.phase_rad), *([None] * 7)]
    if e is not None:
        numbers[2:] = [*e.e_t_m, e.e_t_norm_m, math.degrees(e.e_r_rad), e.e_c, frame.nees]
    return {"name": frame.filename, "status": frame.status, "numbers": [number(value) for value in numbers]}


def _found_cells(record: PoseRecord) -> dict[str, str]:
    """Texts of one row of a run without truth."""
    T, P = record.T_cam_target, record.covariance
    sigma = None if P is None else np.sqrt(np.diagonal(P))
    return {
        "name": record.filename,
        "status": record.status,
        "range": number(None if T is None else float(np.linalg.norm(T.t_m))),
        "sigma_m": number(None if sigma is None else float(np.linalg.norm(sigma[:3]))),
        "sigma_deg": number(None if sigma is None else math.degrees(float(np.linalg.norm(sigma[3:])))),
    }


def _gallery(run: Run) -> Iterator[dict[str, str]]:
    order = [run.frames[k] for k in from_best_to_worst(run.frames)]
    budget = _PICTURE_BYTES // max(1, min(_PICTURES, len(run.pictures)))
    for picture in run.pictures[:_PICTURES]:
        yield {
            "source": "data:image/jpeg;base64," + base64.b64encode(_jpeg(picture.path, budget)).decode(),
            "place": f"{picture.place + 1} of {len(order) or len(run.pictures)}",
            "text": picture.path.stem if run.found else _picture_text(picture, order),
        }


def _picture_text(picture: Picture, order: list[PairedFrame]) -> str:
    """What the picture shows. Frames without a pose share the last places in any order: they are not named."""
    frame = order[picture.place] if picture.place < len(order) else None
    if frame is None or frame.errors is None:
        return "no pose"
    e = frame.errors
    numbers = f"E_T {e.e_t_norm_m:.3g} m, E_R {math.degrees(e.e_r_rad):.3g} deg, E_C {e.e_c:.3g}"
    return f"{frame.filename}: {numbers}, range {frame.range_m:.1f} m"


def _jpeg(path: Path, budget: int) -> bytes:
    """The picture as JPEG of at most `budget` bytes, or as small as we make it."""
    image = read_image(path)
    encoded = b""
    for side, quality in _SIZES:
        scale = min(1.0, side / max(image.shape[:2]))
        small = image if scale == 1.0 else cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
        encoded = encode_jpeg(small, quality)
        if len(encoded) <= budget:
            break
    return encoded


def _pair(value: Any) -> tuple[str, str]:
    return (number(value[0]), number(value[1])) if isinstance(value, list) and len(value) == 2 else ("–", "–")


def _text(name: str) -> str:
    return (_PAGE / name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    """What the page's security policy calls the one style or script that it allows."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
