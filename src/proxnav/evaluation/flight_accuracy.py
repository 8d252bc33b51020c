"""How accurate and how honest the filter was over a flight, and over many."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from proxnav.evaluation.navigation_errors import NavErrors
from proxnav.records import NAV_ERRORS


def accuracy(errors: NavErrors) -> dict[str, Any]:
    """Root mean squares over the second half, when the filter has settled, and honesty over all of it."""
    settled = errors.t >= 0.5 * (errors.t[0] + errors.t[-1])
    rms = np.sqrt(np.nanmean(errors.errors[settled] ** 2, axis=0))
    return {
        "rms_position_m": rms[NAV_ERRORS.position].tolist(), "rms_velocity_mps": rms[NAV_ERRORS.velocity].tolist(),
        "rms_attitude_deg": np.rad2deg(rms[NAV_ERRORS.attitude]).tolist(),
        "mean_nees_of_12": float(np.nanmean(errors.nees)),
        "inside_3_sigma": float(np.nanmean(errors.inside_3_sigma)),
    }  # fmt: skip


def mean_accuracy(summaries: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Root mean squares [m, deg] of norms and means of the rest, over the flights of which the truth is known."""
    known = [s for s in summaries if s.get("rms_position_m") is not None]
    found: dict[str, Any] = {"flights": len(summaries), "with_truth": len(known)}
    found["starts"] = sum(s["starts"] for s in summaries)
    for name in ("rms_position_m", "rms_velocity_mps", "rms_attitude_deg"):
        if known:
            norms = np.linalg.norm(np.array([s[name] for s in known], dtype=np.float64), axis=1)
            found[name] = float(np.sqrt(np.nanmean(norms**2)))
            found[name.replace("rms", "p95")] = float(np.nanpercentile(norms, 95))
    for name in ("mean_nees_of_12", "inside_3_sigma"):
        if known:
            found[name] = float(np.nanmean(np.array([s[name] for s in known], dtype=np.float64)))
    return found


def accuracy_line(found: Mapping[str, Any]) -> str:
    """The accuracy of one flight or of many for people."""
    position, turn = (float(np.linalg.norm(found[name])) for name in ("rms_position_m", "rms_attitude_deg"))
    return (
        f"second half: position {position:.3f} m, attitude {turn:.3f} deg RMS; "
        f"inside 3 sigma {100 * found['inside_3_sigma']:.1f} %, mean NEES of 12: {found['mean_nees_of_12']:.1f}"
    )
