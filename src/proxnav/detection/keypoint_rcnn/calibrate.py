"""How much to trust the spread of a map: scale and floor of the covariance, from errors on labelled images."""

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize

from proxnav.detection.keypoint_rcnn.decode import Calibration
from proxnav.errors import InputError

FREEDOM = 4.0
"""Degrees of freedom of the Student t likelihood: mistaken keypoints must not widen the honest ones."""
FEWEST = 30


def fit_calibration(errors_px: Float[np.ndarray, "m 2"], spreads_px2: Float[np.ndarray, "m 2 2"]) -> Calibration:
    """Scale and floor of the greatest likelihood of `errors_px` (found minus true).

    `spreads_px2` are the covariances that `detect` gives with `Calibration(scale=1, floor_px=0)`; NaN rows count not.
    """
    found = np.isfinite(errors_px).all(axis=1) & np.isfinite(spreads_px2).all(axis=(1, 2))
    errors, spreads = errors_px[found], spreads_px2[found]
    if len(errors) < FEWEST:
        raise InputError(f"{len(errors)} keypoints found in the validation images; calibration needs {FEWEST} or more")

    def cost(logs: Float[np.ndarray, "2"]) -> float:
        scale, variance = np.exp(logs)
        covariances = scale * spreads + variance * np.eye(2)
        squared = np.einsum("ni,nij,nj->n", errors, np.linalg.inv(covariances), errors)
        return float(
            (0.5 * np.linalg.slogdet(covariances)[1] + 0.5 * (FREEDOM + 2) * np.log1p(squared / FREEDOM)).mean()
        )

    best = minimize(cost, np.log([1.0, 0.1]), method="Nelder-Mead", bounds=[(-7.0, 7.0), (-9.0, 7.0)])
    scale, variance = np.exp(best.x)
    return Calibration(scale=float(scale), floor_px=float(np.sqrt(variance)))
