"""Vectors of three for compiled code: anything with three places goes in, a tuple comes out, nothing is allocated."""

from proxnav.geometry.compiled.kernel import kernel, ray_kernel


@kernel
def triple(row, first):
    """Three neighbouring places of a row."""
    return row[first], row[first + 1], row[first + 2]


@kernel
def put(row, first, v):
    """Writes a vector to three neighbouring places of a row."""
    row[first], row[first + 1], row[first + 2] = v[0], v[1], v[2]


@kernel
def minus(a, b):
    """a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel
def plus(a, s, b):
    """a + s b."""
    return a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]


@kernel
def times(s, a):
    """s a."""
    return s * a[0], s * a[1], s * a[2]


@ray_kernel
def over(a, s):
    """a / s; infinity or NaN where s is zero."""
    return a[0] / s, a[1] / s, a[2] / s


@kernel
def dot(a, b):
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a, b):
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def rotate(R, v):
    """R v."""
    return (
        R[0, 0] * v[0] + R[0, 1] * v[1] + R[0, 2] * v[2],
        R[1, 0] * v[0] + R[1, 1] * v[1] + R[1, 2] * v[2],
        R[2, 0] * v[0] + R[2, 1] * v[1] + R[2, 2] * v[2],
    )
