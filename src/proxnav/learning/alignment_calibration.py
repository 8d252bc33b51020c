"""The covariances of alignments made honest on frames whose truth is known."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from scipy.optimize import root_scalar

from proxnav.geometry import Pose
from proxnav.geometry.mahalanobis import squared_mahalanobis
from proxnav.geometry.perturbation import difference
from proxnav.pose.align.align import Alignment
from proxnav.pose.align.config import AlignConfig

POWERS = (0.0, 0.5, 1.0, 1.5, 2.0)
"""Powers of the keypoints' doubt that are compared."""
KEPT = 0.98
"""Quantile of squared errors; one beyond it is a confusion, which no scale should cover, and counts as the quantile."""
_USUAL_PART = 0.45
"""Factor on the median share of the outline on edges: an image that shows less of it contradicts the pose."""


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """What alignments said and how wrong they were, one row each."""

    errors: Float[np.ndarray, "k 6"]
    """From the truth to the aligned pose: translation [m], rotation [rad], camera axes."""
    outlines: Float[np.ndarray, "k 6 6"]
    """Covariances of the outline alone."""
    spreads: Float[np.ndarray, "k 6 6"]
    """Covariances of the poses that explain the image nearly as well: taken as they are."""
    doubts: Float[np.ndarray, "k"]
    """1 - median keypoint score."""
    edge_shares: Float[np.ndarray, "k"]
    """Shares of the outline on edges."""

    @staticmethod
    def of(found: Sequence[tuple[Alignment, Pose]], config: AlignConfig) -> "Samples":
        """From alignments made under `config`, and the true poses."""
        scale = config.covariance_scale
        return Samples(
            np.array([difference(one.T_cam_target, truth) for one, truth in found]),
            np.array([one.outline_covariance / config.widening(one.doubt) for one, _ in found]),
            np.array([one.covariance - scale * one.outline_covariance for one, _ in found]),
            np.array([one.doubt for one, _ in found]),
            np.array([one.edge_share for one, _ in found]),
        )


def calibrated(config: AlignConfig, samples: Samples) -> AlignConfig:
    """`config` with the scale, the power of the doubt and the least share of edges that the samples ask for.

    For each power the scale makes the mean squared normalised error that of 6 normals; the power is the likeliest.
    """
    tried = [_scaled(replace(config, doubt_power=power), samples) for power in POWERS]
    best = max(tried, key=lambda one: _log_likelihood(one, samples))
    return replace(best, least_edge_share=_USUAL_PART * float(np.median(samples.edge_shares)))


def _scaled(config: AlignConfig, samples: Samples) -> AlignConfig:
    def excess(log_scale: float) -> float:
        squared = squared_mahalanobis(samples.errors, _covariances(_with(config, log_scale), samples))
        return float(np.mean(np.minimum(squared, np.quantile(squared, KEPT)))) - 6.0

    low, high = 0.0, float(np.log(1e4))
    if excess(low) <= 0.0 or excess(high) >= 0.0:
        return _with(config, low if excess(low) <= 0.0 else high)
    return _with(config, root_scalar(excess, bracket=(low, high)).root)


def _with(config: AlignConfig, log_scale: float) -> AlignConfig:
    return replace(config, covariance_scale=float(np.exp(log_scale)))


def _covariances(config: AlignConfig, samples: Samples) -> Float[np.ndarray, "k 6 6"]:
    factors = config.covariance_scale * np.array([config.widening(doubt) for doubt in samples.doubts])
    return factors[:, None, None] * samples.outlines + samples.spreads


def _log_likelihood(config: AlignConfig, samples: Samples) -> float:
    """Mean of a normal's, errors beyond the quantile counted as the quantile; constants left out."""
    covariances = _covariances(config, samples)
    squared = squared_mahalanobis(samples.errors, covariances)
    kept = np.minimum(squared, np.quantile(squared, KEPT))
    return -0.5 * float(np.mean(kept + np.linalg.slogdet(covariances)[1]))
