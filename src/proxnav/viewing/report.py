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
from scipy.stats import chi2, norm

from proxnav.datasets.dataset import read_image
from proxnav.viewing.charts import Mark, histogram, linear_axis, log_axis, running_median, scatter
from proxnav.viewing.run_folder import HALF_TURN_RAD, FrameRow, Picture, Run, from_best_to_worst, read_run

STUDY = {
    "mean_e_t_x_m": 0.2978,
    "mean_e_t_y_m": 0.2131,
    "mean_e_t_z_m": 0.3376,
    "mean_e_r_deg": 4.302,
    "mean_e_c": 0.1345,
}
"""Means of the seed study: 100 synthetic images, 10 m to 100 m, Keypoint R-CNN, six keypoints, PnP with RANSAC."""

_ROWS = (
    ("mean_e_t_x_m", "mean E_T, x (right)", "m"),
    ("mean_e_t_y_m", "mean E_T, y (down)", "m"),
    ("mean_e_t_z_m", "mean E_T, z (forward)", "m"),
    ("mean_e_t_norm_m", "mean E_T, norm", "m"),
    ("mean_e_tn", "mean E_TN = norm / range", "-"),
    ("mean_e_r_deg", "mean E_R", "deg"),
    ("mean_e_c", "mean E_C = E_TN + E_R [rad]", "-"),
    ("median_e_t_norm_m", "median E_T, norm", "m"),
    ("p95_e_t_norm_m", "95th percentile E_T, norm", "m"),
    ("median_e_r_deg", "median E_R", "deg"),
    ("p95_e_r_deg", "95th percentile E_R", "deg"),
    ("median_e_c", "median E_C", "-"),
)
_AXES = ("x right [m]", "y down [m]", "z forward [m]", "about x [rad]", "about y [rad]", "about z [rad]")
_PICTURES = 150
_PICTURE_BYTES = 8_000_000  # of all pictures together; base64 adds a third
_SIZES = ((1024, 85), (1024, 70), (768, 70), (512, 70), (384, 60), (256, 50))  # longer side [px], JPEG quality
_PAGE = Path(__file__).parent / "page"


def report_html(folder: Path, title: str) -> str:
    """The report of the run in `folder` (poses.json, truth.json, metrics.json, overlays/, config.json if any)."""
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
        translation_chart=Markup(_range_chart(run.frames, "e_t_norm_m", "position error E_T [m]", 1.0, math.inf)),
        rotation_chart=Markup(_range_chart(run.frames, "e_r_rad", "attitude error E_R [deg]", 180.0 / math.pi, 180.0)),
        calibration=_calibration(run),
        frames=[_frame_cells(frame) for frame in run.frames],
        statuses=sorted({frame.status for frame in run.frames}),
        gallery=list(_gallery(run)),
        hidden=max(0, len(run.pictures) - _PICTURES),
        config=list(flattened(run.config)),
    )


def headline(metrics: Mapping[str, Any]) -> Iterator[dict[str, str]]:
    """Rows of the headline table: label, unit, study, ours, 95 % interval; a dash where there is no number."""
    axes = metrics.get("mean_e_t_m")
    values = dict(metrics)
    if isinstance(axes, list) and len(axes) == 3:
        values |= dict(zip(("mean_e_t_x_m", "mean_e_t_y_m", "mean_e_t_z_m"), axes, strict=True))
    intervals = metrics.get("intervals")
    for key, label, unit in _ROWS:
        low, high = _pair(intervals.get(key) if isinstance(intervals, dict) else None)
        yield {
            "label": label,
            "unit": unit,
            "study": _number(STUDY.get(key)),
            "ours": _number(values.get(key)),
            "interval": "–" if low == "–" else f"{low} to {high}",
        }


def coverage(frames: tuple[FrameRow, ...]) -> dict[str, str]:
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


def _range_chart(frames: tuple[FrameRow, ...], key: str, label: str, scale: float, at_most: float) -> str:
    marks, posed = [], [frame for frame in frames if frame.errors is not None]
    values = [float(getattr(frame.errors, key)) * scale for frame in posed]
    for frame, value in zip(posed, values, strict=True):
        wrong = frame.errors is not None and frame.errors.e_r_rad > HALF_TURN_RAD
        text = f"{frame.filename}: {value:.4g} at {frame.range_m:.1f} m"
        marks.append(Mark(frame.range_m, value, text, "outlier" if wrong else "point"))
    lost = [frame for frame in frames if frame.errors is None]
    marks += [Mark(f.range_m, 0.0, f"{f.filename}: {f.status} at {f.range_m:.1f} m", "none") for f in lost]
    x = linear_axis("true range [m]", [frame.range_m for frame in frames])
    line = running_median([frame.range_m for frame in posed], values)
    name = f"{label} against true range, {len(posed)} poses"
    return scatter(name, x, log_axis(label, values, at_most), marks, line)


def _calibration(run: Run) -> dict[str, Any] | None:
    """Chart of normalised squared errors and the shares inside k sigma per axis; None without covariances."""
    errors = [frame.errors for frame in run.frames if frame.errors is not None and frame.errors.nees is not None]
    if not errors:
        return None
    normalised = np.abs(np.array([error.normalised for error in errors]))
    nees = np.array([error.nees for error in errors], dtype=np.float64)
    inside = [
        (axis, [f"{100.0 * np.mean(normalised[:, k] <= n):.1f} %" for n in (1, 2, 3)]) for k, axis in enumerate(_AXES)
    ]
    return {
        "poses": len(errors),
        "mean": _number(float(nees.mean())),
        "median": _number(float(np.median(nees))),
        "honest_median": _number(float(chi2.median(6))),
        "inside": inside,
        "honest": [f"{100.0 * (2.0 * norm.cdf(n) - 1.0):.1f} %" for n in (1, 2, 3)],
        "chart": Markup(_nees_chart(nees)),
    }


def _nees_chart(nees: np.ndarray) -> str:
    top = 24.0  # chi-square with 6 degrees of freedom leaves 0.05 % beyond
    edges = np.linspace(0.0, top, 17)
    counts = np.histogram(np.minimum(nees, top - 1e-9), edges)[0] / (len(nees) * np.diff(edges))
    places = np.linspace(0.0, top, 121)
    line = [(float(a), float(b)) for a, b in zip(places, chi2.pdf(places, 6), strict=True)]
    x = linear_axis(f"squared normalised error, 6 numbers [-]; last bar: all above {edges[-2]:g}", [0.0, top], True)
    name = (
        f"Histogram of the squared normalised errors of {len(nees)} poses against chi-square with 6 degrees of freedom"
    )
    return histogram(name, x, edges, counts, "density [-]", line)


def _frame_cells(frame: FrameRow) -> dict[str, Any]:
    """Texts and sort keys of one row of the table of frames."""
    e = frame.errors
    numbers = [frame.range_m, *([None] * 7)]
    if e is not None:
        numbers = [frame.range_m, *e.e_t_m, e.e_t_norm_m, math.degrees(e.e_r_rad), e.e_c, e.nees]
    return {"name": frame.filename, "status": frame.status, "numbers": [_number(number) for number in numbers]}


def _gallery(run: Run) -> Iterator[dict[str, str]]:
    order = from_best_to_worst(run.frames)
    budget = _PICTURE_BYTES // max(1, min(_PICTURES, len(run.pictures)))
    for picture in run.pictures[:_PICTURES]:
        yield {
            "source": "data:image/jpeg;base64," + base64.b64encode(_jpeg(picture.path, budget)).decode(),
            "place": f"{picture.place + 1} of {len(order)}",
            "text": _picture_text(picture, order),
        }


def _picture_text(picture: Picture, order: list[FrameRow]) -> str:
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
    pixels = np.ascontiguousarray(image[..., ::-1] if image.ndim == 3 else image)
    encoded = b""
    for side, quality in _SIZES:
        scale = min(1.0, side / max(pixels.shape[:2]))
        small = pixels if scale == 1.0 else cv2.resize(pixels, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
        encoded = cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()
        if len(encoded) <= budget:
            break
    return encoded


def _number(value: Any) -> str:
    if not isinstance(value, int | float) or isinstance(value, bool) or not math.isfinite(value):
        return "–"
    return f"{value:.4g}"


def _pair(value: Any) -> tuple[str, str]:
    return (_number(value[0]), _number(value[1])) if isinstance(value, list) and len(value) == 2 else ("–", "–")


def _text(name: str) -> str:
    return (_PAGE / name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    """What the page's security policy calls the one style or script that it allows."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
