"""Points along those edges of a mesh that may be seen as lines in the image."""

import math

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.lens import project
from proxnav.geometry.compiled.vectors import dot, minus

_NEAREST_M = 1e-6


@kernel
def _faces_eye(n, a, eye):
    return dot(n, minus(eye, a)) > 0.0


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
        ua, va = project(R, t, a[i], lens, _NEAREST_M)
        ub, vb = project(R, t, b[i], lens, _NEAREST_M)
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
