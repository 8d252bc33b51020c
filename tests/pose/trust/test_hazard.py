"""A probability that means what it says, from few parameters, in which doubt never helps."""

import numpy as np
import pytest

from proxnav.pose.trust import Evidence, Similarity
from proxnav.pose.trust.evidence import Doubts, doubt_rows
from proxnav.pose.trust.hazard import KEPT, HazardModel, fitted_hazard, usual_doubts

TRUE = np.array([0.8, 0.5, 0.4, 0.0, 0.3, 2.5, 0.2])


def drawn(n: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Doubts of n poses, and which are hazardous by a logistic law."""
    rng = np.random.default_rng(seed)
    doubts = rng.normal(size=(n, len(Doubts._fields)))
    odds = -5.0 + doubts @ TRUE
    return doubts, rng.random(n) < 1.0 / (1.0 + np.exp(-odds))


@pytest.fixture(scope="module")
def model() -> HazardModel:
    return fitted_hazard(*drawn(4000, 1), risk=1e-3)


def test_the_law_that_made_the_hazards_is_found(model: HazardModel) -> None:
    np.testing.assert_allclose(model.weights, TRUE, atol=0.45)
    assert model.constant == pytest.approx(-5.0, abs=0.6)


def test_probabilities_on_other_frames_are_the_shares_that_come_true(model: HazardModel) -> None:
    doubts, wrong = drawn(8000, 2)
    p = model.probabilities(doubts)
    for low, high in ((0.0, 0.02), (0.02, 0.2), (0.2, 0.6), (0.6, 1.0)):
        inside = (p >= low) & (p < high)
        noise = np.sqrt(max(p[inside].mean(), 1e-3) / inside.sum())
        assert wrong[inside].mean() == pytest.approx(p[inside].mean(), abs=4.0 * noise + 0.02)


def test_doubt_never_helps_even_where_the_frames_say_so() -> None:
    doubts, wrong = drawn(300, 3)
    doubts[:, 0] = -2.0 * wrong  # hazardous poses with sure keypoints
    assert (fitted_hazard(doubts, wrong, 1e-3).weights >= 0.0).all()


def test_few_frames_keep_what_was_expected_and_say_the_risk_that_they_carry() -> None:
    doubts, wrong = drawn(60, 4)
    model = fitted_hazard(doubts, wrong, 1e-3)
    assert model.view > 1.5
    kept = model.probabilities(doubts) <= model.limit
    assert kept[~wrong].mean() >= KEPT - 0.02
    assert model.expected_risk == pytest.approx(model.probabilities(doubts)[kept].mean(), abs=1e-5)


def test_evidence_that_is_the_same_everywhere_has_no_weight() -> None:
    doubts, wrong = drawn(300, 5)
    doubts[:, Doubts._fields.index("view")] = 0.0
    assert fitted_hazard(doubts, wrong, 1e-3).view == 0.0


def test_evidence_becomes_doubts_that_grow_with_it() -> None:
    good = Evidence(0.995, 0.8, 0.01, 0.003, 0.6, Similarity(0.9, 0.1))
    worse = Evidence(0.9, 0.4, 0.2, 0.05, 1e-6, Similarity(0.4, 0.1), 0.5)
    assert (np.array(worse.doubts()) > np.array(good.doubts())).all()
    assert doubt_rows([]).shape == (0, 7)


def test_the_strongest_doubt_is_the_one_that_stands_out() -> None:
    model = HazardModel(-5.0, 1.0, 1.0, 1.0, 1.0, 1.0, 3.0, 0.1, limit=0.1, expected_risk=0.01)
    usual = Evidence(0.995, 0.8, 0.01, 0.003, 0.6, Similarity(0.9, 0.1))
    medians = usual_doubts(doubt_rows([usual]))
    for name, odd in (("view", usual.seen(Similarity(0.2, 0.1))), ("edges", Evidence(0.995, 0.0, 0.01, 0.003, 0.6))):
        assert model.strongest(odd, medians) == name
