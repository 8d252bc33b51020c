"""Largest distance of two points of a set."""

from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.distance import pdist

from proxnav.geometry.types import Points


def diameter(points: Points) -> float:
    """Largest distance of two points, in their unit; 0 of a single one.

    >>> import numpy as np
    >>> diameter(np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]]))
    5.0
    """
    try:
        corners = points[ConvexHull(points).vertices]
    except (QhullError, ValueError):  # flat, or few points
        corners = points
    return float(pdist(corners).max(initial=0.0))
