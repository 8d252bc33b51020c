"""Alignments whose errors are drawn from a known law give that law back."""

import numpy as np
import pytest

from proxnav.learning.alignment_calibration import Samples, calibrated
from proxnav.pose.align import AlignConfig


def samples(rng, scale: float, power: float, count: int = 3000) -> Samples:
    """Errors of covariance scale * (doubt's widening) * outline + spread."""
    truth = AlignConfig(covariance_scale=scale, doubt_power=power)
    roots = rng.normal(size=(count, 6, 6)) * 1e-2
    outlines = roots @ roots.transpose(0, 2, 1) + 1e-5 * np.eye(6)
    spreads = np.broadcast_to(1e-5 * np.eye(6), outlines.shape)
    doubts = rng.uniform(0.001, 0.05, count)
    factors = scale * np.array([truth.widening(doubt) for doubt in doubts])
    errors = [
        rng.multivariate_normal(np.zeros(6), f * A + B) for f, A, B in zip(factors, outlines, spreads, strict=True)
    ]
    return Samples(np.array(errors), outlines, spreads, doubts, rng.uniform(0.5, 0.7, count))


@pytest.mark.parametrize(("scale", "power"), [(16.0, 1.5), (4.0, 0.0), (300.0, 0.5)])
def test_scale_and_power_are_found_again(rng, scale: float, power: float) -> None:
    found = calibrated(AlignConfig(), samples(rng, scale, power))
    assert found.doubt_power == power
    assert found.covariance_scale == pytest.approx(scale, rel=0.05)
    assert found.least_edge_share == pytest.approx(0.27, abs=0.01)


def test_a_confusion_in_a_hundred_moves_the_scale_little(rng) -> None:
    honest = samples(rng, 16.0, 1.0)
    honest.errors[::100] *= 1000.0
    found = calibrated(AlignConfig(), honest)
    assert found.doubt_power == 1.0
    assert found.covariance_scale == pytest.approx(16.0, rel=0.15)


def test_errors_without_scatter_end_at_the_least_scale(rng) -> None:
    exact = samples(rng, 16.0, 0.0, 100)
    exact.errors[:] = 0.0
    assert calibrated(AlignConfig(), exact).covariance_scale == 1.0
