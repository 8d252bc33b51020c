"""Names for the array shapes that travel through the package; the meaning is in the name, the check in the tests.

Leading axes named `*#batch` broadcast against each other as NumPy does: one quaternion may turn many vectors.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, UInt, UInt8

Vector3 = Float[np.ndarray, "*#batch 3"]
"""Vectors or points; the frame is in the variable's name."""

QuatWxyz = Float[np.ndarray, "*#batch wxyz=4"]
"""Hamilton quaternions, scalar first, unit, active: v_a = R(q_a_b) v_b."""

Rotation3x3 = Float[np.ndarray, "*#batch 3 3"]
Pixels = Float[np.ndarray, "*#batch 2"]
"""Image points [px], corner origin: the first pixel's centre is (0.5, 0.5)."""

Box = Float[np.ndarray, "xyxy=4"]
"""x0, y0, x1, y1 [px], outer edges."""

PoseCovariance = Float[np.ndarray, "6 6"]
"""Covariance of (dt [m], dr [rad]), translation first: t_true = t + dt, R_true = exp(dr) R."""

Points = Float[np.ndarray, "n_keypoints 3"]
Flags = Bool[np.ndarray, "n_keypoints"]

Image = UInt[np.ndarray, "height width *rgb"]
"""Counts of an image, uint8 or uint16, grey or RGB; the first row is on top."""

GreyImage = UInt8[np.ndarray, "height width"]
Mask = Bool[np.ndarray, "height width"]
"""Where the target is in an image."""

Numbers = np.ndarray | Sequence[Any]
"""An array or nested lists of numbers, as a user may type them; converted on entry."""
