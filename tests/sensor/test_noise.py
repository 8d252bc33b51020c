"""Random numbers of a pixel: the right distributions, and independent where they must be."""

import numpy as np
import pytest
from numba import njit
from scipy import stats

from proxnav.sensor import noise


@njit
def _normals(key, height, width):
    out = np.empty((height, width))
    for i in range(height):
        row = noise.line_key(key, i)
        for j in range(width):
            out[i, j] = noise.normal(noise.pixel_bits(row, j))
    return out


@njit
def _poissons(key, mean, count):
    out = np.empty(count)
    row = noise.line_key(key, 0)
    for j in range(count):
        out[j] = noise.poisson(mean, noise.pixel_bits(row, j))
    return out


def test_normals_follow_the_normal_distribution_into_the_tails():
    z = _normals(noise.stream_key(1, "test"), 1000, 1000).ravel()
    assert stats.kstest(z, "norm").pvalue > 1e-3
    assert z.std() == pytest.approx(1.0, abs=3e-3)
    assert stats.kurtosis(z) == pytest.approx(0.0, abs=0.02)
    beyond = (np.abs(z) > 3.442619855899).sum()  # the ziggurat's tail layer
    assert beyond == pytest.approx(1e6 * 2 * stats.norm.sf(3.442619855899), abs=4 * np.sqrt(576))


def test_neighbouring_pixels_rows_and_streams_are_uncorrelated():
    a = _normals(noise.stream_key(1, "test"), 500, 500)
    b = _normals(noise.stream_key(2, "test"), 500, 500)
    c = _normals(noise.stream_key(1, "other"), 500, 500)
    pairs = [(a[:, 1:], a[:, :-1]), (a[1:], a[:-1]), (a[1:, 1:], a[:-1, :-1]), (a, b), (a, c)]
    for one, other in pairs:
        assert abs(np.corrcoef(one.ravel(), other.ravel())[0, 1]) < 4.0 / 500


@pytest.mark.parametrize("mean", [0.01, 0.7, 5.0, 24.9, 25.1, 60.0, 1000.0])
def test_poisson_numbers_follow_the_poisson_distribution(mean: float):
    n = _poissons(noise.stream_key(3, "test"), mean, 400_000)
    low, high = stats.poisson.ppf([1e-4, 1 - 1e-4], mean)
    edges = np.unique(np.linspace(low, high + 1, min(int(high - low) + 2, 60)).astype(int))
    observed = np.histogram(np.clip(n, edges[0], edges[-1] - 1), np.r_[edges - 0.5])[0]
    cdf = stats.poisson.cdf(edges - 1, mean)
    cdf[0], cdf[-1] = 0.0, 1.0
    expected = np.diff(cdf) * n.size
    keep = expected > 5
    chi2 = ((observed - expected)[keep] ** 2 / expected[keep]).sum()
    assert stats.chi2.sf(chi2, max(keep.sum() - 1, 1)) > 1e-4
    assert n.mean() == pytest.approx(mean, abs=4 * np.sqrt(mean / n.size))
    assert n.var() == pytest.approx(mean, rel=0.01 + 4 / np.sqrt(mean * n.size))


def test_no_light_gives_no_electrons():
    assert not _poissons(noise.stream_key(3, "test"), 0.0, 1000).any()
    assert not _poissons(noise.stream_key(3, "test"), -1.0, 1000).any()


@pytest.mark.parametrize("seed", [0, -1, 2**63, 2**70])
def test_any_integer_is_a_seed(seed: int):
    assert isinstance(noise.generator(seed, "x").random(), float)
