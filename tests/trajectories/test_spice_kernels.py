"""SPICE kernels: small ones, written by spiceypy itself, give the flight that went in."""

import sys
from pathlib import Path

import numpy as np
import pytest
import spiceypy as spice

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.records import Trajectory
from proxnav.trajectories import FlightConfig, HoldConfig, OrbitConfig, ReaderConfig, hold, read_trajectory

FLIGHT = hold(HoldConfig(duration_s=600.0, step_s=30.0), FlightConfig("2024-11-01T06:00:00Z", OrbitConfig(500e3, 51.6)))
ET = 783712869.184 + FLIGHT.t  # of 2024-11-01T06:00:00 UTC, TT within 2 ms
IDS = {"target": -1001, "chaser": -1002}


def spk(path: Path, flight: Trajectory = FLIGHT, centre: int = 399) -> Path:
    """Both craft, Hermite polynomials of degree 7 (type 13)."""
    handle = spice.spkopn(str(path), "test", 0)
    orbits = {"target": (flight.r_eci_target_m, flight.v_eci_target_mps),
              "chaser": (flight.r_eci_chaser_m, flight.v_eci_chaser_mps)}  # fmt: skip
    for name, (r, v) in orbits.items():
        states = np.hstack([r, v]) / 1e3
        spice.spkw13(handle, IDS[name], centre, "J2000", ET[0], ET[-1], name, 7, len(ET), states, ET)
    spice.spkcls(handle)
    return path


def clock(path: Path) -> Path:
    """A clock of the target that ticks 65536 times a second of TDB from J2000 on."""
    n = -IDS["target"]
    path.write_text(
        "KPL/SCLK\n\\begindata\n"
        "SCLK_KERNEL_ID = ( @2024-11-01 )\n"
        f"SCLK_DATA_TYPE_{n} = ( 1 )\nSCLK01_TIME_SYSTEM_{n} = ( 1 )\nSCLK01_N_FIELDS_{n} = ( 2 )\n"
        f"SCLK01_MODULI_{n} = ( 4294967296 65536 )\nSCLK01_OFFSETS_{n} = ( 0 0 )\nSCLK01_OUTPUT_DELIM_{n} = ( 1 )\n"
        f"SCLK_PARTITION_START_{n} = ( 0.0 )\nSCLK_PARTITION_END_{n} = ( 2.8147E+14 )\n"
        f"SCLK01_COEFFICIENTS_{n} = ( 0.0 0.0 1.0 )\n\\begintext\n"
    )
    return path


def ck(path: Path, sclk: Path) -> Path:
    """The target's attitude, interpolated linearly (type 3)."""
    spice.furnsh(str(sclk))
    ticks = np.array([spice.sce2c(IDS["target"], t) for t in ET])
    handle = spice.ckopn(str(path), "test", 0)
    turns = quaternion.to_matrix(quaternion.conjugate(FLIGHT.q_eci_target))  # from reference to body
    spice.ckw03(
        handle, ticks[0], ticks[-1], IDS["target"] * 1000, "J2000", True, "target", len(ET), ticks,
        np.array([spice.m2q(turn) for turn in turns]), np.zeros((len(ET), 3)), 1, ticks[:1],
    )  # fmt: skip
    spice.ckcls(handle)
    spice.unload(str(sclk))
    return path


def test_both_craft_of_an_spk_fly_as_they_went_in(tmp_path):
    path = spk(tmp_path / "flight.bsp")
    back = read_trajectory([path], ReaderConfig(target="-1001", chaser="-1002", step_s=30.0))
    assert back.epoch_utc.startswith(("2024-11-01T06:00:00.00", "2024-11-01T05:59:59.99"))
    n = min(len(back), len(FLIGHT))
    assert back.range_m == pytest.approx(np.full(len(back), 30.0), abs=1e-5)
    assert back.r_eci_target_m[:n] == pytest.approx(FLIGHT.r_eci_target_m[:n], abs=20.0)  # 2 ms of TDB at 7.6 km/s
    assert len(read_trajectory([path], ReaderConfig(target="-1001"))) == 21  # each 30 s


def test_an_attitude_of_a_ck_is_that_of_its_craft(tmp_path):
    sclk = clock(tmp_path / "clock.tsc")
    kernels = [spk(tmp_path / "flight.bsp"), ck(tmp_path / "attitude.bc", sclk), sclk]
    back = read_trajectory(kernels, ReaderConfig(target="-1001", step_s=60.0))
    expected = FLIGHT.q_eci_target[::2][: len(back)]
    assert np.max(quaternion.angle_between(back.q_eci_target[: len(expected)], expected)) < 1e-5


def test_kernels_are_unloaded_again(tmp_path):
    before = spice.ktotal("ALL")
    read_trajectory([spk(tmp_path / "flight.bsp")], ReaderConfig(target="-1001"))
    assert spice.ktotal("ALL") == before


def test_what_spice_lacks_or_refuses_is_one_sentence(tmp_path, monkeypatch):
    moon = spk(tmp_path / "moon.bsp", centre=301)
    with pytest.raises(InputError, match=r"moon\.bsp: SPICE says .*SPKINSUFFDATA.*; give the kernels that are missing"):
        read_trajectory([moon])
    sclk = clock(tmp_path / "clock.tsc")
    with pytest.raises(InputError, match="text kernels alone; give an SPK"):
        read_trajectory([sclk])
    damaged = tmp_path / "cut.bsp"
    damaged.write_bytes(moon.read_bytes()[:700])
    with pytest.raises(InputError, match=r"cut\.bsp: SPICE says"):
        read_trajectory([damaged])
    with pytest.raises(InputError, match=r"covers 600 s, 60000001 steps of 1e-05 s, of which 300000"):
        read_trajectory([spk(tmp_path / "flight.bsp")], ReaderConfig(step_s=1e-5))
    monkeypatch.setitem(sys.modules, "spiceypy", None)
    with pytest.raises(InputError, match=r"SPICE kernels, which spiceypy reads: pip install 'proxnav\[spice\]'"):
        read_trajectory([moon])
