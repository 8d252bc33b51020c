"""The measurement update in Joseph form."""

import numpy as np

from proxnav.geometry.compiled.kernel import kernel


@kernel
def joseph(P, columns, H, R, y):
    """(error step, covariance, normalised innovation squared) of a measurement y = H e[columns] + noise.

    P+ = (I - K H) P (I - K H)^T + K R K^T, multiplied out so that only the measured columns meet H.
    """
    HP = H @ P[columns]
    S = HP[:, columns] @ H.T + R
    both = np.linalg.solve(S, np.column_stack((HP, y)))
    Kt = np.ascontiguousarray(both[:, :-1])
    AP = P - Kt.T @ HP
    out = AP - (AP[:, columns] @ H.T - Kt.T @ R) @ Kt
    return Kt.T @ y, rounded(out, P), y @ np.ascontiguousarray(both[:, -1])


@kernel
def rounded(out, prior):
    """Symmetric, with the rounding errors of the update (some ulp of the prior) on the safe side of zero."""
    out = 0.5 * (out + out.T)
    for i in range(len(out)):
        out[i, i] += 2e-15 * prior[i, i]
    return out
