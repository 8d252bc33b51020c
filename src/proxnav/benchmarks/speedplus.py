"""A model on the images of SPEED+: scores of the field by domain, range and light, beside what others have published.

T. H. Park et al., "SPEED+: Next-Generation Dataset for Spacecraft Pose Estimation across Domain Gap", IEEE Aerospace
Conference 2022. The data set is not part of this package; its folders are read as it is distributed.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.benchmarks.speedplus_folders import Domain, find_domains
from proxnav.cluster.jobs import POOL
from proxnav.cluster.progress import Progress, silent
from proxnav.detection.sessions import Backend
from proxnav.estimation import estimate_images
from proxnav.evaluation.combined_errors import COMBINED
from proxnav.evaluation.consistency import consistency
from proxnav.evaluation.pairing import PairedFrame, errors_of, pair
from proxnav.evaluation.summary import mean_interval
from proxnav.geometry import Camera
from proxnav.images.codecs import read_image
from proxnav.images.tones import grey_8_bit

RANGES_M = (0.0, 4.0, 6.0, 8.0, np.inf)
DARK_DN, SATURATED_SHARE = 60.0, 0.01
"""A picture is dark where 98 % of it lie below this count, saturated where more than this share is full."""
GROSS_DEG = 10.0

PUBLISHED = (
    ("SPNv2, phi 3, style augmentation, no adaptation", 0.175, 6.48, 0.142),
    ("SPNv2, refined on the unlabelled images", 0.142, 5.62, 0.122),
    ("RTMPose-SimCC M, 224 px", None, None, 0.120),
    ("RTMPose-SimCC S, 224 px", None, None, 0.144),
    ("SPNv3 M, 448 px", None, None, 0.060),
)
"""Who, mean E_T [m], mean E_R [deg], mean E_C, on all 6740 lightbox images; docs/benchmarks/real.md has the sources."""


@dataclass(frozen=True, slots=True)
class Source:
    """What is measured, and by what."""

    root: Path
    model: str
    limit: int = 0
    """Images of each domain at most, evenly over it; 0 takes all."""
    camera_or: Callable[[Callable[[], Camera]], Camera] = lambda own: own()
    """The camera to use, from the one beside the images."""


def measure_speedplus(
    source: Source, backend: Backend = "auto", workers: int = 1, on: str = POOL, progress: Progress = silent
) -> dict[str, Any]:
    """Rows of numbers for each domain under `root`, in all and by range and light; InputError where it has none."""
    domains = find_domains(source.root, source.limit)
    found = {domain.name: _measured(domain, source, backend, workers, on, progress) for domain in domains}
    return {"model": source.model, "root": source.root.name, "domains": found}


def _measured(
    domain: Domain, source: Source, backend: Backend, workers: int, on: str, progress: Progress
) -> dict[str, Any]:
    camera = source.camera_or(domain.camera)
    with progress(domain.name, len(domain.images)) as done:
        records, _ = estimate_images(domain.images, camera, source.model, backend, 0, workers, on, done)
    frames = pair({record.filename: record for record in records}, domain.truth)
    groups = {"all": frames} | _by_range(frames) | _by_light(frames, domain.images)
    rows = {name: score_row(some) for name, some in groups.items() if some}
    return {"rows": rows, "frames": [_frame(frame) for frame in frames], "images_without_a_file": domain.missing}


def _by_range(frames: Sequence[PairedFrame]) -> dict[str, list[PairedFrame]]:
    """Frames by true range."""
    edges = list(pairwise(RANGES_M))
    return {f"{low:g}-{high:g} m": [f for f in frames if low <= f.range_m < high] for low, high in edges}


def _by_light(frames: Sequence[PairedFrame], images: Sequence[Path]) -> dict[str, list[PairedFrame]]:
    light = {path.name: light_of(grey_8_bit(read_image(path))) for path in images}
    return {name: [f for f in frames if light[f.filename] == name] for name in ("dark", "saturated", "even light")}


def light_of(image: Float[np.ndarray, "h w"]) -> str:
    """Dark, saturated or even light."""
    if np.percentile(image, 98.0) < DARK_DN:
        return "dark"
    return "saturated" if (image == 255).mean() > SATURATED_SHARE else "even light"


def score_row(frames: Sequence[PairedFrame]) -> dict[str, Any]:
    """Scores over the frames with a pose, beside how many there are and what a user must fear."""
    errors, honest = errors_of(frames), consistency(frames)
    row: dict[str, Any] = {
        "frames": len(frames),
        "poses": len(errors),
        "hazardous": sum(frame.is_hazardous for frame in frames),
        "gross_and_sure": sum(_is_gross_and_sure(frame) for frame in frames),
    }
    if not errors:
        return row
    turn, e_c = np.degrees([e.e_r_rad for e in errors]), np.array([e.e_c for e in errors])
    return row | {
        "inside_3_sigma": None if honest is None else 1.0 - honest.beyond_3_sigma,
        "below_10_deg": float((turn < GROSS_DEG).sum() / len(frames)),
        **_mean_and_median("e_t_m", np.array([e.e_t_norm_m for e in errors])),
        **_mean_and_median("e_r_deg", turn),
        **_mean_and_median("e_c", e_c),
        "scores": {name: float(np.mean([score(e) for e in errors])) for name, score in COMBINED.items()},
    }


def _mean_and_median(name: str, values: Float[np.ndarray, "n"]) -> dict[str, Any]:
    draws = np.random.default_rng(0).integers(0, len(values), (1000, len(values)))
    medians = np.percentile(np.median(values[draws], axis=1), [2.5, 97.5])
    return {
        f"mean_{name}": float(values.mean()),
        f"mean_{name}_interval": list(mean_interval(values)),
        f"median_{name}": float(np.median(values)),
        f"median_{name}_interval": medians.tolist(),
    }


def _is_gross_and_sure(frame: PairedFrame) -> bool:
    """The worst outcome: off by more than 10 deg, and the truth outside the claimed 3 sigma."""
    gross = frame.errors is not None and np.degrees(frame.errors.e_r_rad) > GROSS_DEG
    return bool(gross and (np.abs(frame.normalised) > 3.0).any())


def _frame(frame: PairedFrame) -> dict[str, Any]:
    numbers: Mapping[str, float] = {}
    if frame.errors is not None:
        numbers = {"e_t_m": frame.errors.e_t_norm_m, "e_r_deg": float(np.degrees(frame.errors.e_r_rad)),
                   "e_c": frame.errors.e_c}  # fmt: skip
    return {"filename": frame.filename, "range_m": frame.range_m, "status": frame.status, **numbers}


def table(found: dict[str, Any]) -> str:
    """The rows as text, beside the published ones."""
    blocks = [_domain_table(name, domain) for name, domain in found["domains"].items()]
    others = [f"{'published, lightbox, 6740 images':50s} {'E_T mean':>9s} {'E_R mean':>9s} {'E_C mean':>9s}"]
    for who, e_t, e_r, e_c in PUBLISHED:
        cells = ["-" if value is None else f"{value:.3f}" for value in (e_t, e_r, e_c)]
        others.append(f"{who:50s} " + " ".join(f"{cell:>9s}" for cell in cells))
    return "\n\n".join([*blocks, "\n".join(others)])


def _domain_table(domain: str, found: dict[str, Any]) -> str:
    head = ("poses", "hazard", "<10 deg", "E_T mean", "E_R med", "E_R mean", "E_C med", "E_C mean", "3 sigma")
    lines = [f"{domain:12s} " + " ".join(f"{name:>9s}" for name in head)]
    for name, row in found["rows"].items():
        lines.append(f"{name:12s} " + " ".join(f"{cell:>9s}" for cell in _cells(row)))
    whole = found["rows"]["all"]
    if whole["poses"]:
        (a, b), (c, d) = whole["median_e_r_deg_interval"], whole["mean_e_c_interval"]
        lines.append(f"95 % intervals: median E_R {a:.2f} .. {b:.2f} deg, mean E_C {c:.4f} .. {d:.4f}")
        lines += [f"  {name}: {value:.4f}" for name, value in whole["scores"].items()]
    if found["images_without_a_file"]:
        lines.append(f"{found['images_without_a_file']} labels have no image beside them and are left out")
    return "\n".join(lines)


def _cells(row: Mapping[str, Any]) -> list[str]:
    cells = [f"{row['poses']}/{row['frames']}", str(row["hazardous"])]
    if not row["poses"]:
        return [*cells, *["-"] * 7]
    sure = "-" if row["inside_3_sigma"] is None else f"{100 * row['inside_3_sigma']:.0f} %"
    numbers = (row["mean_e_t_m"], row["median_e_r_deg"], row["mean_e_r_deg"], row["median_e_c"], row["mean_e_c"])
    return [*cells, f"{100 * row['below_10_deg']:.0f} %", *(f"{value:.4g}" for value in numbers), sure]
