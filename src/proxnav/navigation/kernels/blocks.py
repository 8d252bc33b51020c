"""Blocks of a matrix by name."""

from proxnav.geometry.compiled.kernel import kernel


@kernel
def set_diagonal(A, rows, columns, value):
    """A[rows, columns] = value * I on its diagonal, the rest of the block left as it is."""
    for i in range(rows.stop - rows.start):
        A[rows.start + i, columns.start + i] = value


@kernel
def set_symmetric(A, rows, columns, value):
    """`set_diagonal` of a block and of its transpose."""
    set_diagonal(A, rows, columns, value)
    set_diagonal(A, columns, rows, value)
