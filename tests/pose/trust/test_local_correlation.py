"""Likeness of two views."""

import numpy as np
import pytest

from proxnav.pose.trust import TrustConfig, local_correlation
from proxnav.pose.trust.verdict import verdict_of

SIDE = 96
RNG = np.random.default_rng(2)
MASK = np.zeros((SIDE, SIDE), bool)
MASK[10:80, 20:90] = True


def picture(seed: int = 0) -> np.ndarray:
    """Faces of several tones."""
    return np.kron(np.random.default_rng(seed).uniform(0.1, 1.0, (8, 8)), np.ones((12, 12)))


def test_a_view_is_like_itself_whatever_its_exposure() -> None:
    found = local_correlation(picture(), 37.0 * picture(), MASK)
    assert found is not None
    assert found.score == pytest.approx(1.0, abs=0.04)


def test_another_picture_the_negative_and_a_shifted_one_are_not_alike() -> None:
    scores = [
        local_correlation(picture(), other, MASK).score
        for other in (picture(1), 1.1 - picture(), np.roll(picture(), 12, axis=1))
    ]
    assert max(scores) < 0.5
    assert scores[1] < -0.5


def test_what_lies_outside_the_mask_changes_nothing() -> None:
    seen = picture().copy()
    seen[~MASK] = RNG.uniform(0.0, 1.0, (~MASK).sum())
    inner = np.zeros_like(MASK)
    inner[14:76, 24:86] = True
    clean, noisy = (local_correlation(picture(), view, inner).score for view in (picture(), seen))
    assert noisy == pytest.approx(clean, abs=1e-6)


def test_an_even_prediction_cannot_be_verified_and_an_empty_one_not_compared() -> None:
    even = local_correlation(np.full((SIDE, SIDE), 0.5), picture(), MASK)
    assert verdict_of(even, TrustConfig()) == "not_verifiable"
    assert local_correlation(picture(), picture(), np.zeros_like(MASK)) is None
    assert verdict_of(None, TrustConfig()) == "not_verifiable"


def test_the_verdict_follows_the_least_similarity() -> None:
    alike = local_correlation(picture(), picture(), MASK)
    unlike = local_correlation(picture(), picture(1), MASK)
    assert verdict_of(alike, TrustConfig()) == "verified"
    assert verdict_of(unlike, TrustConfig()) == "contradicted"
