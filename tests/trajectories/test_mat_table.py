"""MATLAB files: variables, matrices and structures by name; version 7.3 by h5py."""

import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from proxnav.errors import InputError, InputNote
from proxnav.geometry.relative_motion import ric_from_eci
from proxnav.trajectories import ReaderConfig, read_trajectory

T = np.arange(0.0, 60.0, 10.0)
RHO = np.stack([1.0 + 0.1 * T, -30.0 + 0.2 * T, 2.0 - 0.05 * T], axis=-1)


def ric(path: Path, **options: object) -> np.ndarray:
    with pytest.warns(InputNote, match="m from the target, whose orbit is"):
        flight = read_trajectory([path], ReaderConfig(**options))  # pyright: ignore
    assert flight.t == pytest.approx(T)
    return ric_from_eci(flight.r_eci_target_m, flight.v_eci_target_mps, flight.r_eci_chaser_m, flight.v_eci_chaser_mps)[
        0
    ]


LAYOUTS = {
    "columns": ({"t": T, "vbar_m": RHO[:, 1], "hbar_m": -RHO[:, 2], "rbar_m": -RHO[:, 0]}, {}),
    "matrix": ({"time_s": T[:, None], "r_ric_m": RHO}, {}),
    "lying": ({"t": T, "rho_lvlh": np.stack([RHO[:, 1], -RHO[:, 2], -RHO[:, 0]])}, {}),
    "structure": ({"flight": {"t": T, "r_ric_m": RHO, "note": "a text"}}, {}),
    "one matrix": (
        {"data": np.c_[T, RHO]}, {"columns": ("t", "radial", "in-track", "cross-track"), "position_unit": "m"}
    ),
    "kilometres": (dict(zip(("t", "x_km", "y_km", "z_km"), (T, *RHO.T / 1e3), strict=True)), {"frame": "RIC"}),
}  # fmt: skip


@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_layout_holds_the_same_flight(tmp_path, layout):
    variables, options = LAYOUTS[layout]
    savemat(tmp_path / "flight.mat", variables)
    assert ric(tmp_path / "flight.mat", **options) == pytest.approx(RHO, abs=1e-6)


def hdf5(path: Path) -> Path:
    """Written as MATLAB writes version 7.3: 512 bytes of its own, arrays transposed, a group per structure."""
    with h5py.File(path, "w", userblock_size=512) as file:
        file["flight/t"] = T[None, :]
        file["flight/r_ric_m"] = RHO.T
        file["#refs#/a"] = np.zeros((1, 3))
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + b"\x00\x02IM")
    return path


def test_version_7_3_is_read_by_h5py(tmp_path):
    assert ric(hdf5(tmp_path / "flight.mat")) == pytest.approx(RHO, abs=1e-6)


def test_without_h5py_version_7_3_says_what_to_install(tmp_path, monkeypatch):
    path = hdf5(tmp_path / "flight.mat")
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(InputError, match=r"a MATLAB 7\.3 file, which h5py reads: pip install 'proxnav\[matlab\]'"):
        read_trajectory([path])


def test_two_crafts_are_two_structures(tmp_path):
    r = np.stack([7e6 + 0.0 * T, 7.5e3 * T, 0.0 * T], axis=-1)
    path = tmp_path / "both.mat"
    savemat(path, {"t": T, "target": {"r_m": r}, "chaser": {"r_m": r + np.array([0.0, -30.0, 0.0])}})
    flight = read_trajectory([path], ReaderConfig(frame="ICRF"))
    assert flight.range_m == pytest.approx(np.full(len(T), 30.0), abs=1e-6)


@pytest.mark.parametrize(
    ("content", "said"),
    [(b"MATLAB 5.0 MAT-file" + bytes(200), "not readable as a MATLAB file|no numbers in it"),
     (b"\x89HDF\r\n\x1a\n" + bytes(64), r"not readable as MATLAB 7\.3")],
)  # fmt: skip
def test_a_damaged_file_is_one_sentence(tmp_path, content, said):
    (tmp_path / "flight.mat").write_bytes(content)
    with pytest.raises(InputError, match=said):
        read_trajectory([tmp_path / "flight.mat"])


@pytest.mark.parametrize(
    ("variables", "options", "said"),
    [({"T": "only text"}, {}, "no numbers in it; .* a timetable T is an object that MATLAB alone reads"),
     ({"m": np.eye(7)}, {}, r"no series of times and positions in m of 7 x 7; name columns with --reader\.columns"),
     ({"data": np.c_[T, RHO]}, {"columns": ("t", "x")}, r"names 2 columns, which one of data of 6 x 4 must have"),
     ({"t": T, "foo": RHO[:, :2]}, {}, r"no position nor quaternion among the columns t, foo_x, foo_y"),
     ({"t": T, "r": RHO}, {}, r"does not say the axes of r_x, r_y, r_z")],
)  # fmt: skip
def test_what_is_not_there_or_left_open_is_one_sentence(tmp_path, variables, options, said):
    savemat(tmp_path / "flight.mat", variables)
    with pytest.raises(InputError, match=said):
        read_trajectory([tmp_path / "flight.mat"], ReaderConfig(**options))
