"""How large an error is against the covariance that was claimed for it."""

import numpy as np
from jaxtyping import Float


def squared_mahalanobis(
    errors: Float[np.ndarray, "*k n"], covariances: Float[np.ndarray, "*k n n"]
) -> Float[np.ndarray, "*k"]:
    """e^T C^-1 e of one error or a stack of them (NEES); infinite where C is not positive.

    Scaled to unit diagonals first: metres and radians live in one matrix.

    >>> float(squared_mahalanobis(np.array([2.0, 3.0]), np.diag([4.0, 1.0])))
    10.0
    """
    scale = np.sqrt(np.maximum(np.diagonal(covariances, axis1=-2, axis2=-1), 1e-300))
    correlations = covariances / (scale[..., :, None] * scale[..., None, :])
    try:
        roots = np.linalg.cholesky(correlations)
    except np.linalg.LinAlgError:
        if errors.ndim == 1:
            return np.array(np.inf)
        return np.array([squared_mahalanobis(e, C) for e, C in zip(errors, covariances, strict=True)])
    halves = np.linalg.solve(roots, (errors / scale)[..., None])[..., 0]
    return np.asarray(np.sum(halves**2, axis=-1))
