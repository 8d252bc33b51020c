"""Pose errors as distances of the object's surface: ADD, ADD-S, MSSD and MSPD.

ADD, ADD-S: Hinterstoisser et al., ACCV 2012. MSSD, MSPD: Hodan et al., BOP Challenge 2020, section 2.2.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from proxnav.evaluation.object_model import ObjectModel
from proxnav.evaluation.pairing import PairedFrame
from proxnav.geometry import Camera, Pose

ADD_SHARE = 0.1
"""Part of the diameter below which a pose counts as right by ADD."""
_MSSD_SHARES = np.arange(0.05, 0.501, 0.05)
_MSPD_PX = np.arange(5.0, 50.01, 5.0)  # in images 640 px wide, in proportion in others
_BOP_WIDTH = 640.0


@dataclass(frozen=True, slots=True)
class SurfaceErrors:
    """Distances of the surface at an estimated pose from that at the true one."""

    add_m: float
    """Mean distance of corresponding points."""
    add_s_m: float
    """Mean distance from each true point to the nearest estimated one."""
    mssd_m: float
    """Largest distance of corresponding points, at the symmetry where that is least."""
    mspd_px: float
    """The same in the image; NaN without a camera, infinite behind it."""


def surface_errors(T_est: Pose, T_true: Pose, model: ObjectModel, camera: Camera | None = None) -> SurfaceErrors:
    """Errors of T_cam_target.

    >>> T_true = Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [0, 0, 10])
    >>> T_est = Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [0.3, 0, 10.4])
    >>> round(surface_errors(T_est, T_true, ObjectModel.of_points(np.eye(3))).add_m, 6)
    0.5
    """
    estimated, true = T_est @ model.points_m, T_true @ model.points_m
    symmetric = [(T_true @ turn) @ model.points_m for turn in model.symmetries]
    mspd = np.nan
    if camera is not None:
        seen = camera.project(estimated)
        mspd = min(_largest(seen - camera.project(one)) for one in symmetric)
    return SurfaceErrors(
        add_m=float(np.linalg.norm(estimated - true, axis=1).mean()),
        add_s_m=float(KDTree(estimated).query(true)[0].mean()),
        mssd_m=min(_largest(estimated - one) for one in symmetric),
        mspd_px=float(mspd),
    )


@dataclass(frozen=True, slots=True)
class SurfaceScores:
    """Means over the poses, and recalls over all frames: a frame without a pose is missed."""

    mean_add_m: float
    mean_add_s_m: float
    mean_mssd_m: float
    mean_mspd_px: float
    add_recall: float
    """Share of frames with ADD below a tenth of the diameter."""
    add_s_recall: float
    ar_mssd: float
    """Mean recall at 0.05 to 0.5 of the diameter."""
    ar_mspd: float
    """Mean recall at 5 to 50 px in an image 640 px wide; NaN without a camera."""


def surface_scores(frames: Sequence[PairedFrame], model: ObjectModel, camera: Camera | None) -> SurfaceScores:
    """Scores of paired frames. The BOP challenge's third error, VSD, needs depth images and is left out."""
    found = [surface_errors(f.T_est, f.T_true, model, camera) for f in frames if f.T_est is not None]
    add, add_s, mssd, mspd = (
        np.array([getattr(one, name) for one in found]) for name in ("add_m", "add_s_m", "mssd_m", "mspd_px")
    )
    n, size = len(frames), model.diameter_m
    scale = np.nan if camera is None else camera.width / _BOP_WIDTH
    return SurfaceScores(
        _mean(add), _mean(add_s), _mean(mssd), _mean(mspd),
        _recall(add, [ADD_SHARE * size], n), _recall(add_s, [ADD_SHARE * size], n),
        _recall(mssd, _MSSD_SHARES * size, n),
        np.nan if camera is None else _recall(mspd, _MSPD_PX * scale, n),
    )  # fmt: skip


def _recall(errors: Float[np.ndarray, "n"], below: Sequence[float] | Float[np.ndarray, "k"], frames: int) -> float:
    """Mean over the limits of the share of frames below each."""
    return float(np.mean([(errors < limit).sum() / frames for limit in below]))


def _largest(apart: Float[np.ndarray, "n k"]) -> float:
    return float(np.nan_to_num(np.linalg.norm(apart, axis=1), nan=np.inf).max())


def _mean(values: Float[np.ndarray, "n"]) -> float:
    return float(values.mean()) if len(values) else float("nan")
