"""How likely honest keypoints are to leave such residuals: all of them count, outliers among them."""

import numpy as np
from jaxtyping import Float
from scipy.special import bdtrc, chdtrc

from proxnav.geometry.types import Flags

OUTLIER_RATE = 0.3
"""Share of keypoints that an honest detector puts anywhere, occluded ones for the most part."""


def residual_chance(d2: Float[np.ndarray, "used"], inliers: Flags, noise_unknown: bool) -> float:
    """p-value of the residuals under a mixture: a keypoint is an outlier at `OUTLIER_RATE`, else normal as it claims.

    `d2` are squared normalised errors. The chance of so many outliers and the chance of so large errors of the others
    are combined by Fisher's method; where the noise was itself taken from the residuals, only outliers count.
    """
    n, k = len(d2), int(np.count_nonzero(~inliers))
    outliers = 1.0 if k == 0 else float(bdtrc(k - 1, n, OUTLIER_RATE))
    free = 2 * (n - k) - 6
    if noise_unknown or free < 1:
        return outliers
    others = float(chdtrc(free, float(d2[inliers].sum())))
    product = max(outliers * others, 1e-300)
    return float(chdtrc(4, -2.0 * np.log(product)))
