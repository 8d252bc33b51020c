"""Random numbers that belong to a pixel: a hash of (seed, column, row), so that no order or window changes them.

Counter-based generation after J. K. Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011, with the
finaliser of splitmix64 (G. L. Steele et al., "Fast splittable pseudorandom number generators", OOPSLA 2014).
"""

import numpy as np

from proxnav.geometry.compiled.kernel import kernel, pasted_kernel

_MASK = (1 << 64) - 1
_GOLDEN = 0x9E3779B97F4A7C15  # 2^64 / golden ratio, odd
GOLDEN = np.uint64(_GOLDEN)
_M1, _M2 = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_S11, _S27, _S30, _S31 = np.uint64(11), np.uint64(27), np.uint64(30), np.uint64(31)
_LAYER = np.uint64(127)
_TO_UNIT = 2.0**-53


def stream_key(seed: int, stream: str) -> np.uint64:
    """Key of one independent stream of numbers, from any integer seed and the stream's name."""
    z = seed & _MASK
    for byte in stream.encode():
        z = ((z ^ byte) + _GOLDEN) & _MASK
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & _MASK
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & _MASK
        z ^= z >> 31
    return np.uint64(z)


def generator(seed: int, stream: str) -> np.random.Generator:
    """A NumPy generator of its own for what does not belong to a pixel, such as particle tracks."""
    return np.random.Generator(np.random.Philox(key=int(stream_key(seed, stream))))


@pasted_kernel
def mix(z):
    """The splitmix64 finaliser: a bijection of 64 bits in which each output bit depends on every input bit."""
    z = (z ^ (z >> _S30)) * _M1
    z = (z ^ (z >> _S27)) * _M2
    return z ^ (z >> _S31)


@pasted_kernel
def line_key(key, line):
    """Key of one row (or column) of the sensor."""
    return mix(key + np.uint64(line) * GOLDEN)


@pasted_kernel
def pixel_bits(row_key, column):
    """64 random bits of one pixel."""
    return mix(row_key + np.uint64(column) * GOLDEN)


@pasted_kernel
def uniform(bits):
    """Uniform in [0, 1) from 64 random bits."""
    return np.float64(bits >> _S11) * _TO_UNIT


def _ziggurat() -> tuple[np.ndarray, np.ndarray]:
    """Right edges of the 128 layers of equal area under exp(-x^2/2), and the ratio of each to the one below."""
    tail_start, area = 3.442619855899, 9.91256303526217e-3
    edges = np.zeros(129)
    edges[0], edges[1] = area / np.exp(-0.5 * tail_start**2), tail_start
    for i in range(2, 128):
        below = edges[i - 1]
        edges[i] = np.sqrt(-2.0 * np.log(area / below + np.exp(-0.5 * below**2)))
    return edges, edges[1:] / edges[:-1]


_EDGES, _RATIOS = _ziggurat()


@kernel
def _normal_rare(bits, u, layer):
    """The one case in a hundred where the ziggurat's first test fails: wedge or tail, hashing on for more numbers."""
    while True:
        bits = mix(bits + GOLDEN)
        if layer == 0:
            x = -np.log(1.0 - uniform(bits)) / _EDGES[1]
            bits = mix(bits + GOLDEN)
            if -2.0 * np.log(1.0 - uniform(bits)) >= x * x:
                return _EDGES[1] + x if u > 0 else -_EDGES[1] - x
            continue
        x = u * _EDGES[layer]
        outer = np.exp(-0.5 * (_EDGES[layer] ** 2 - x * x))
        inner = np.exp(-0.5 * (_EDGES[layer + 1] ** 2 - x * x))
        if inner + uniform(bits) * (outer - inner) < 1.0:
            return x
        bits = mix(bits + GOLDEN)
        layer = np.int64(bits & _LAYER)
        u = 2.0 * uniform(bits) - 1.0
        if abs(u) < _RATIOS[layer]:
            return u * _EDGES[layer]


@pasted_kernel
def normal(bits):
    """Standard normal from 64 random bits (J. A. Doornik, "An improved ziggurat method", 2005)."""
    layer = np.int64(bits & _LAYER)
    u = 2.0 * uniform(bits) - 1.0
    if abs(u) < _RATIOS[layer]:
        return u * _EDGES[layer]
    return _normal_rare(bits, u, layer)


_EXACT_BELOW = 25.0  # electrons; above, the Cornish-Fisher quantile is within 1e-3 of the distribution function
_INVERSE = 1.0 / np.maximum(np.arange(128), 1)


@kernel
def poisson(mean, bits):
    """Poisson number of the given mean: inversion when small, else the normal quantile corrected for skewness.

    Cornish-Fisher expansion to third order; 1/12 is the variance that rounding adds (Sheppard).
    """
    if mean <= 0.0:
        return 0.0
    if mean < _EXACT_BELOW:
        u = uniform(bits)
        term = np.exp(-mean)
        total = term
        k = 0
        while u > total and k < 127:
            k += 1
            term *= mean * _INVERSE[k]
            total += term
        return float(k)
    z = normal(bits)
    root = np.sqrt(mean - 1.0 / 12.0)
    value = mean + z * root + (z * z - 1.0) / 6.0 + (z - z * z * z) / (72.0 * root)
    return max(np.floor(value + 0.5), 0.0)
