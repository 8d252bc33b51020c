"""The study's Table 1 beside ours, and the table by range, as plain text."""

from collections.abc import Mapping, Sequence

import numpy as np

from proxnav.evaluation.consistency import Consistency, Efficiency
from proxnav.evaluation.summary import Summary
from proxnav.evaluation.surface_errors import SurfaceScores
from proxnav.evaluation.trajectory_errors import TrajectoryErrors

STUDY = {
    "mean_e_t_x_m": 0.2978,
    "mean_e_t_y_m": 0.2131,
    "mean_e_t_z_m": 0.3376,
    "mean_e_r_deg": 4.302,
    "mean_e_c": 0.1345,
}
"""Table 1 of the seed study: means over 100 synthetic images from 10 m to 100 m, Keypoint R-CNN, six keypoints, PnP
with RANSAC. It states neither the axes of E_T nor its definition of E_C."""

HEADLINE = {
    "mean_e_t_x_m": ("mean E_T, x (right)", "m"),
    "mean_e_t_y_m": ("mean E_T, y (down)", "m"),
    "mean_e_t_z_m": ("mean E_T, z (forward)", "m"),
    "mean_e_t_norm_m": ("mean E_T, norm", "m"),
    "mean_e_tn": ("mean E_TN = norm / range", "-"),
    "mean_e_r_deg": ("mean E_R", "deg"),
    "mean_e_c": ("mean E_C = E_TN + E_R [rad]", "-"),
    "median_e_t_norm_m": ("median E_T, norm", "m"),
    "p95_e_t_norm_m": ("95th percentile E_T, norm", "m"),
    "median_e_r_deg": ("median E_R", "deg"),
    "p95_e_r_deg": ("95th percentile E_R", "deg"),
    "median_e_c": ("median E_C", "-"),
}
"""Label and unit of each number of a run, in the order of the table."""


def table1(summary: Summary) -> str:
    """Means beside the study's, with 95 % intervals; frames without a pose and half-turn confusions are named."""
    means = dict(zip(list(HEADLINE)[:3], summary.mean_e_t_m, strict=True))
    rows = [("", "unit", "study", "ours", "95 % interval")]
    for key, (label, unit) in HEADLINE.items():
        value = means[key] if key in means else getattr(summary, key)
        study = f"{STUDY[key]:.4g}" if key in STUDY else "-"
        interval = "{:.4g} .. {:.4g}".format(*summary.intervals[key]) if key in summary.intervals else ""
        rows.append((label, unit, study, f"{value:.4g}", interval))
    return f"{_aligned(rows)}\n\n{_coverage(summary)}\n\n{_definitions(summary)}"


def range_table(bins: Mapping[tuple[float, float], Summary]) -> str:
    """One row per range bin."""
    rows = [["range [m]", "poses", "E_T [m]", "E_TN", "E_R [deg]", "median E_R", "E_C", "half turns", "hazardous"]]
    for (near, far), s in bins.items():
        numbers = (s.mean_e_t_norm_m, s.mean_e_tn, s.mean_e_r_deg, s.median_e_r_deg, s.mean_e_c)
        cells = [f"{number:.4g}" for number in numbers]
        rows.append([f"{near:g}-{far:g}", f"{s.poses}/{s.frames}", *cells, str(s.half_turns), str(s.hazardous)])
    return _aligned(rows)


def consistency_line(found: Consistency | None) -> str:
    """Honesty of the claimed covariances, in one line."""
    if found is None:
        return "covariance: the estimates claim none"
    low, high = found.nees_interval
    return (
        f"covariance: mean NEES {found.mean_nees:.2f} over {found.poses} poses (honest: 6, 95 % in {low:.2f} .. "
        f"{high:.2f}); {100.0 * found.beyond_3_sigma:.1f} % beyond 3 sigma (honest: 0.3 %)"
    )


def efficiency_table(bins: Mapping[tuple[float, float], Efficiency]) -> str:
    """Errors over the Cramer-Rao bound, one row per range bin; nothing where no bound is known."""
    if not bins:
        return "Cramer-Rao bound: known for none of these frames"
    rows = [
        ["range [m]", "poses", "RMS E_T [m]", "bound", "ratio", "median", "RMS E_R [deg]", "bound", "ratio", "median"]
    ]
    for (near, far), one in bins.items():
        turn = np.degrees([one.rms_r_rad, one.bound_r_rad])
        numbers = (one.rms_t_m, one.bound_t_m, one.translation, one.median_t, *turn, one.rotation, one.median_r)
        rows.append([f"{near:g}-{far:g}", str(one.poses), *(f"{number:.3g}" for number in numbers)])
    return "errors over the Cramer-Rao bound (keypoints in sight, each known to 1 px per axis):\n" + _aligned(rows)


def score_table(
    spark: float, recall: Mapping[str, float], surface: SurfaceScores | None, trajectory: TrajectoryErrors | None
) -> str:
    """Scores in the dialects of others; those that need a surface or times only where these are known."""
    rows = [("score", "", "")]
    rows.append(("SPARK: mean E_T [m] + mean E_R [rad]", f"{spark:.4g}", ""))
    rows += [(f"recall at {name}", f"{100.0 * share:.1f}", "%") for name, share in recall.items()]
    if surface is not None:
        rows += [
            ("mean ADD", f"{surface.mean_add_m:.4g}", "m"),
            ("mean ADD-S", f"{surface.mean_add_s_m:.4g}", "m"),
            ("mean MSSD", f"{surface.mean_mssd_m:.4g}", "m"),
            ("mean MSPD", f"{surface.mean_mspd_px:.4g}", "px"),
            ("recall of ADD at 0.1 diameter", f"{100.0 * surface.add_recall:.1f}", "%"),
            ("recall of ADD-S at 0.1 diameter", f"{100.0 * surface.add_s_recall:.1f}", "%"),
            ("AR of MSSD (BOP)", f"{100.0 * surface.ar_mssd:.1f}", "%"),
            ("AR of MSPD (BOP)", f"{100.0 * surface.ar_mspd:.1f}", "%"),
        ]
    if trajectory is not None:
        rows += [
            ("APE of the camera, RMSE, not aligned", f"{trajectory.ape_m.rmse:.4g}", "m"),
            ("the same of attitude", f"{trajectory.ape_deg.rmse:.4g}", "deg"),
            ("RPE from pose to pose, RMSE", f"{trajectory.rpe_m.rmse:.4g}", "m"),
            ("the same of attitude", f"{trajectory.rpe_deg.rmse:.4g}", "deg"),
        ]
    return _aligned(rows)


def _coverage(s: Summary) -> str:
    without = ", ".join(f"{count} {status}" for status, count in s.statuses.items() if status != "ok")
    share = 100.0 * s.poses / s.frames
    return (
        f"{s.poses} poses in {s.frames} frames ({share:.1f} %); without a pose: {without or 'none'}; "
        f"half-turn confusions (E_R > 90 deg): {s.half_turns}; hazardous: {s.hazardous}"
    )


def _definitions(summary: Summary) -> str:
    rows = [("mean combined error by definition", "ours")]
    rows += [(name, f"{value:.4g}") for name, value in summary.combined.items()]
    return _aligned(rows)


def _aligned(rows: Sequence[Sequence[str]]) -> str:
    """Columns padded to their widest cell, a rule under the first row; the first column to the left."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    lines = ["  ".join(map(str.rjust, row, widths)) for row in rows]
    lines = [row[0].ljust(widths[0]) + line[widths[0] :] for row, line in zip(rows, lines, strict=True)]
    rule = "  ".join("-" * width for width in widths)
    return "\n".join(line.rstrip() for line in (lines[0], rule, *lines[1:]))
