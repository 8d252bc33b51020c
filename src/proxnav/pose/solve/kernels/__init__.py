"""The inner loops of the pose solver, compiled by numba: bare arrays, no annotations, SI and corner-origin pixels.

Conventions: p_cam = R p_target + t; `lens` is a row as in proxnav.geometry.compiled.lens; `side` is +1 for points in
front of the camera and -1 for points behind it; `info` holds rows as in `weights`; `d2` is a squared Mahalanobis
distance of one point, chi-square with 2 degrees of freedom.
"""
