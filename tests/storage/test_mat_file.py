"""Our reader of MATLAB matrices against scipy's writer."""

import contextlib
import io

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from proxnav.storage.mat_file import MAX_BYTES, read_matrices


def saved(content: dict, compressed: bool) -> bytes:
    buffer = io.BytesIO()
    savemat(buffer, content, do_compression=compressed)
    return buffer.getvalue()


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("kind", ["f8", "f4", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8"])
def test_matrices_of_every_type_read_as_scipy_wrote_them(kind: str, compressed: bool, rng: np.random.Generator) -> None:
    content = {
        "points": rng.integers(0, 99, (3, 11)).astype(kind),
        "one": np.ones((1, 1), kind),
        "none": np.ones((0, 3)),
    }
    found = read_matrices(saved(content | {"text": "abc", "complex": np.eye(2) * 1j, "cell": [1, "a"]}, compressed))
    assert set(content) <= set(found)
    assert "complex" not in found
    for name, array in content.items():
        np.testing.assert_array_equal(found[name], array)


def test_fields_of_a_structure_read_by_their_path() -> None:
    inner = {"RadialDistortion": np.array([[-0.1, 0.02]]), "label": "text", "deep": {"K": np.eye(3)}}
    found = read_matrices(saved({"params": inner, "many": [{"a": 1.0}, {"a": 2.0}]}, True))
    assert sorted(found) == ["params.RadialDistortion", "params.deep.K"]
    np.testing.assert_array_equal(found["params.deep.K"], np.eye(3))


@settings(max_examples=200, deadline=None)
@given(st.data(), st.booleans())
def test_damaged_files_are_values_or_value_errors(data, compressed: bool) -> None:
    whole = bytearray(saved({"points": np.arange(33.0).reshape(3, 11), "s": {"a": np.eye(2)}}, compressed))
    for _ in range(data.draw(st.integers(1, 6))):
        whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    with contextlib.suppress(ValueError):
        read_matrices(bytes(whole[: data.draw(st.integers(0, len(whole)))]))


def test_a_small_file_that_unpacks_to_much_is_refused() -> None:
    with pytest.raises(ValueError, match="unpacks to more than"):
        read_matrices(saved({"points": np.zeros((3, MAX_BYTES // 24 + 1000))}, True))
