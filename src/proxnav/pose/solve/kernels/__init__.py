"""The inner loops of the pose solver, compiled by numba: bare arrays, no annotations, SI and corner-origin pixels.

Conventions: p_cam = R p_target + t; `lens` = (fx, fy, cx, cy, k1, k2, p1, p2, k3, fold_radius^2); `side` is +1 for
points in front of the camera and -1 for points behind it; `info` holds (a, b, c) of [[a, b], [b, c]], the inverse of
a 2x2 covariance; `d2` is a squared Mahalanobis distance of one point, chi-square with 2 degrees of freedom.

Numba's cache looks at the file of the compiled function, not at its callees in other files: after a change in
`p3p.py` or `lens.py` delete `__pycache__` here, or the callers keep the old code.
"""
