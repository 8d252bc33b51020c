"""What an honest measurement passes: chi-square gates on the normalised innovation squared."""

import numpy as np
from jaxtyping import Float
from scipy.stats import chi2

_POINT, _FRAME, _FIX = 0.99, 0.9999, 0.999
"""Probabilities to pass: a keypoint by itself, a frame or a pose, a fix of GNSS or star tracker.

A frame that is refused costs a second; so many come that one honest frame in 10 000 is seldom enough.
"""
LEAST_SHARE = 0.5
"""A frame counts when at least this share of its keypoints agrees with the prediction."""

POINT_GATE = float(chi2.ppf(_POINT, 2))
POSE_GATE = float(chi2.ppf(_FRAME, 6))
ATTITUDE_GATE = float(chi2.ppf(_FRAME, 3))
"""Attitude of a controlled target, when a pose would start the filter."""
STAR_GATE = float(chi2.ppf(_FIX, 3))
GNSS_GATE = float(chi2.ppf(_FIX, 6))


def frame_gates(most: int) -> Float[np.ndarray, "n"]:
    """Gates of a frame's keypoints together, by degrees of freedom from 0 to `most`."""
    return np.concatenate([[0.0], chi2.ppf(_FRAME, np.arange(1, most + 1))])
