"""MATLAB .mat files as tables: vectors, matrices of three columns and fields of structures by their names."""

from pathlib import Path

import numpy as np
from jaxtyping import Float, Shaped

from proxnav.errors import InputError
from proxnav.storage.mat_file import MAX_BYTES, read_matrices
from proxnav.trajectories.readers.columns import named_components
from proxnav.trajectories.readers.text_table import TextTable

Matrix = Float[np.ndarray, "_ _"]
_HDF5 = b"\x89HDF\r\n\x1a\n"
_OBJECTS = (
    "numbers and structures of numbers are read, a timetable T is an object that MATLAB alone reads: save its columns, "
    "s = table2struct(timetable2table(T), 'ToScalar', true); s.Time = seconds(s.Time); save('f.mat', '-struct', 's')"
)


def is_mat(head: bytes) -> bool:
    """Whether a file begins as MATLAB's do."""
    return head.startswith((b"MATLAB 5.0 MAT-file", b"MATLAB 7.3 MAT-file", _HDF5))


def read_mat(path: str | Path, columns: tuple[str, ...]) -> TextTable:
    """The variables of a .mat file that share their number of rows; `columns` names those of a lone matrix.

    A vector is a column of its own name, a matrix of three columns those of a vector's components. InputError where
    rows do not agree, or nothing is numeric.
    """
    matrices = {name: np.asarray(values, dtype=np.float64) for name, values in _matrices(Path(path)).items()}
    matrices = {name: values for name, values in matrices.items() if values.size}
    if not matrices:
        raise InputError(f"{path}: no numbers in it; {_OBJECTS}")
    names, blocks = _lone(path, matrices, columns) if columns else _series(path, matrices)
    rows = [(k, [repr(float(x)) for x in row]) for k, row in enumerate(np.concatenate(blocks, axis=1), start=1)]
    return TextTable(str(path), names, rows)


def _lone(
    path: str | Path, matrices: dict[str, Matrix], columns: tuple[str, ...]
) -> tuple[tuple[str, ...], list[Matrix]]:
    """The one matrix that has as many columns as were named, or as many rows."""
    wide = [m if m.shape[1] == len(columns) else m.T for m in matrices.values() if len(columns) in m.shape]
    if len(wide) != 1:
        named = f"--reader.columns names {len(columns)} columns"
        raise InputError(f"{path}: {named}, which one of {_sizes(matrices)} must have")
    return columns, wide


def _series(path: str | Path, matrices: dict[str, Matrix]) -> tuple[tuple[str, ...], list[Matrix]]:
    """The variables with as many instants as the longest vector, time downwards: MATLAB's rows lie as often as not."""
    vectors = [m.size for m in matrices.values() if min(m.shape) == 1]
    count = max(vectors, default=0)
    series = {name: m if len(m) == count else m.T for name, m in matrices.items() if count in m.shape}
    series = {name: m for name, m in series.items() if m.shape[1] <= 4}
    if count < 2 or len(series) < 2:
        raise InputError(
            f"{path}: no series of times and positions in {_sizes(matrices)}; name columns with --reader.columns"
        )
    names = [_header(n) for name, m in series.items() for n in named_components(name, m.shape[1])]
    return tuple(names), list(series.values())


def _sizes(matrices: dict[str, Matrix]) -> str:
    return ", ".join(f"{name} of {m.shape[0]} x {m.shape[1]}" for name, m in matrices.items())


def _header(name: str) -> str:
    """A field of a structure as a column of its object: 'chaser.x' is 'chaser - x', the structure's name its owner."""
    owner, _, field = name.rpartition(".")
    return f"{owner} - {field}" if owner and owner.lower() in ("target", "chaser") else field


def _matrices(path: Path) -> dict[str, Shaped[np.ndarray, "rows columns"]]:
    if path.stat().st_size > MAX_BYTES:
        raise InputError(f"{path}: larger than {MAX_BYTES // 2**20} MiB; save fewer instants")
    content = path.read_bytes()
    if content.startswith(b"MATLAB 7.3") or content.startswith(_HDF5):
        return _hdf5(path)
    try:
        return read_matrices(content)
    except ValueError as error:
        raise InputError(f"{path}: not readable as a MATLAB file ({error}); save it again with -v7") from None


def _hdf5(path: Path) -> dict[str, Shaped[np.ndarray, "rows columns"]]:
    """Version 7.3: HDF5, whose arrays are MATLAB's transposed."""
    try:
        import h5py
    except ImportError:
        raise InputError(
            f"{path}: a MATLAB 7.3 file, which h5py reads: pip install 'proxnav[matlab]', or save it with -v7"
        ) from None
    found: dict[str, Shaped[np.ndarray, "rows columns"]] = {}

    def keep(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset) and item.ndim == 2 and item.dtype.kind in "fiu" and "#" not in name:
            found[name.replace("/", ".")] = np.asarray(item[()]).T

    try:
        with h5py.File(path, "r") as file:
            file.visititems(keep)
    except (OSError, RuntimeError, ValueError, TypeError) as error:
        raise InputError(f"{path}: not readable as MATLAB 7.3 ({error}); save it again with -v7") from None
    return found
