"""How well the parts of the target, each shaded smoothly by its normals, explain the image."""

import numpy as np

from proxnav.geometry.compiled.kernel import kernel

TERMS = 4


@kernel
def unexplained_share(image, part, normal, n_parts, most):
    """Share of the image's scatter that is left when each part is fitted by c0 + c . n, and the rest by a plane.

    `image` (rows, columns) root of counts; `part` (rows, columns) index of the part seen, -1 for none; `normal`
    (rows, columns, 3). Residuals beyond `most` count as `most`: shadows and texture are not explained.
    """
    rows, columns = image.shape
    A = np.zeros((n_parts + 1, TERMS, TERMS))
    b = np.zeros((n_parts + 1, TERMS))
    basis = np.empty(TERMS)
    basis[0] = 1.0
    mean = 0.0
    for i in range(rows):
        for j in range(columns):
            p = _basis(i, j, rows, columns, part, normal, n_parts, basis)
            mean += image[i, j]
            for m in range(TERMS):
                b[p, m] += basis[m] * image[i, j]
                for q in range(TERMS):
                    A[p, m, q] += basis[m] * basis[q]
    mean /= rows * columns
    for p in range(n_parts + 1):
        for m in range(TERMS):
            A[p, m, m] += 1e-2
        b[p] = np.linalg.solve(A[p], b[p])
    left, all_ = 0.0, 0.0
    for i in range(rows):
        for j in range(columns):
            p = _basis(i, j, rows, columns, part, normal, n_parts, basis)
            fitted = 0.0
            for m in range(TERMS):
                fitted += basis[m] * b[p, m]
            left += min(abs(image[i, j] - fitted), most) ** 2
            all_ += min(abs(image[i, j] - mean), most) ** 2
    return left / max(all_, 1e-12)


@kernel
def _basis(i, j, rows, columns, part, normal, n_parts, basis):
    """Index of what pixel (i, j) belongs to; fills the terms that shade it."""
    p = part[i, j]
    if p < 0:
        basis[1], basis[2], basis[3] = (j + 0.5) / columns - 0.5, (i + 0.5) / rows - 0.5, 0.0
        return n_parts
    for k in range(3):
        basis[1 + k] = normal[i, j, k]
    return p
