"""Points along those edges of a mesh that may be seen as lines in the image."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.lens import distort


@kernel
def image_of(R, t, X, lens):
    """Pixel (u, v) of a target point; NaN behind the camera or beyond the lens."""
    z = R[2, 0] * X[0] + R[2, 1] * X[1] + R[2, 2] * X[2] + t[2]
    if z <= 1e-6:
        return np.nan, np.nan
    x = (R[0, 0] * X[0] + R[0, 1] * X[1] + R[0, 2] * X[2] + t[0]) / z
    y = (R[1, 0] * X[0] + R[1, 1] * X[1] + R[1, 2] * X[2] + t[1]) / z
    if x * x + y * y > lens[9]:
        return np.nan, np.nan
    u, v, _, _, _, _ = distort(x, y, lens)
    return u, v


@kernel
def _faces_eye(n, a, eye):
    return n[0] * (eye[0] - a[0]) + n[1] * (eye[1] - a[1]) + n[2] * (eye[2] - a[2]) > 0.0


@kernel
def sample_edges(a, b, n1, n2, sharp, R, t, eye, lens, width, height, spacing, X, N):
    """Fills X (points, target frame) and N (unit normals of the edge in the image); returns how many.

    An edge counts where one of its faces looks at the eye and the other away, or where it is sharp and one looks at the
    eye. Points follow each other at `spacing` px along the chain of edges; hidden ones are not yet left out.
    """
    count, ahead = 0, 0.5 * spacing
    for i in range(len(a)):
        front_1, front_2 = _faces_eye(n1[i], a[i], eye), _faces_eye(n2[i], a[i], eye)
        if front_1 == front_2 and not (sharp[i] and front_1):
            continue
        ua, va = image_of(R, t, a[i], lens)
        ub, vb = image_of(R, t, b[i], lens)
        length = math.hypot(ub - ua, vb - va)
        if not (length > 1e-9):
            continue
        while ahead < length:
            share = ahead / length
            u, v = ua + share * (ub - ua), va + share * (vb - va)
            ahead += spacing
            if 0.0 <= u <= width and 0.0 <= v <= height:
                for k in range(3):
                    X[count, k] = a[i, k] + share * (b[i, k] - a[i, k])
                N[count, 0], N[count, 1] = (va - vb) / length, (ub - ua) / length
                count += 1
                if count == len(X):
                    return count
        ahead -= length
    return count
