"""Two files in different Earth frames: relative positions are right, by an independent computation, or refused."""

from pathlib import Path

import brahe
import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.geometry.epochs import parse_iso
from proxnav.records import Trajectory
from proxnav.trajectories import FlightConfig, HoldConfig, OrbitConfig, hold, read_trajectory
from proxnav.trajectories.earth_orientation import earth_orientation, oriented_until
from proxnav.trajectories.readers.reference_frames import ReferenceFrame, q_eci_frame, state_to_eci
from proxnav.trajectories.write import stk_ephemeris

EPOCH = "2024-11-01T06:13:20Z"
FLIGHT = hold(HoldConfig(duration_s=1200.0, step_s=60.0), FlightConfig(EPOCH, OrbitConfig(inclination_deg=97.0)))
BACK = {"Fixed": "state_gcrf_to_itrf", "TEMEOfDate": "state_gcrf_to_teme", "J2000": "state_gcrf_to_eme2000"}


@pytest.fixture(scope="module", autouse=True)
def _earth_of_brahe() -> None:
    """Brahe, whose routines are its own, with the IERS values that it brings."""
    brahe.set_global_eop_provider_from_file_provider(brahe.FileEOPProvider.from_default_standard(True, "Hold"))


def in_frame(flight: Trajectory, name: str) -> tuple[np.ndarray, np.ndarray]:
    """The chaser's states in another frame, by brahe."""
    start = brahe.Epoch.from_string(flight.epoch_utc)
    states = np.hstack([flight.r_eci_chaser_m, flight.v_eci_chaser_mps])
    if name == "J2000":
        turned = np.array([brahe.state_gcrf_to_eme2000(x) for x in states])
    else:
        turned = np.array(
            [getattr(brahe, BACK[name])(start + float(t), x) for t, x in zip(flight.t, states, strict=True)]
        )
    return turned[:, :3], turned[:, 3:]


def write(folder: Path, name: str, flight: Trajectory) -> list[Path]:
    """target.e in ICRF, chaser.e in the other frame."""
    target, chaser = folder / "target.e", folder / "chaser.e"
    target.write_text(stk_ephemeris(flight, "target"))
    head = stk_ephemeris(flight, "chaser").split("EphemerisTimePosVel")[0].replace("ICRF", name)
    rows = [[t, *r, *v] for t, r, v in zip(flight.t, *in_frame(flight, name), strict=True)]
    body = "\n".join(" ".join(f"{x:.12e}" for x in row) for row in rows)
    chaser.write_text(f"{head}EphemerisTimePosVel\n{body}\nEND Ephemeris\n")
    return [target, chaser]


@pytest.mark.parametrize("day", ["2015-06-20", "2024-11-01"])
@pytest.mark.parametrize("name", ["Fixed", "TEMEOfDate", "J2000"])
def test_relative_positions_of_files_in_two_frames_are_right_to_millimetres(tmp_path, name, day):
    polar = FlightConfig(f"{day}T06:13:20Z", OrbitConfig(inclination_deg=97.0))
    flight = hold(HoldConfig(duration_s=1200.0, step_s=60.0), polar)
    back = read_trajectory(write(tmp_path, name, flight))
    assert back.r_eci_chaser_m == pytest.approx(flight.r_eci_chaser_m, abs=2e-3)
    assert back.range_m == pytest.approx(flight.range_m, abs=2e-3)
    assert back.v_eci_chaser_mps == pytest.approx(flight.v_eci_chaser_mps, abs=1e-4)


def test_earth_fixed_velocities_are_the_derivatives_of_inertial_positions():
    epoch, r = parse_iso(EPOCH), np.array([[6.7e6, 1e5, 2e6]])
    t, h = np.array([500.0]), 0.05
    place = [state_to_eci(ReferenceFrame("ecef"), epoch, t + dt, r, 0 * r)[0] for dt in (-h, h)]
    _, v = state_to_eci(ReferenceFrame("ecef"), epoch, t, r, 0 * r)
    assert v == pytest.approx((place[1] - place[0]) / (2 * h), abs=1e-4)


@pytest.mark.parametrize("pair", [("MeanOfDate", "ICRF"), ("TrueOfDate", "MeanOfDate"), ("TrueOfDate", "Fixed")])
def test_frames_that_each_tool_computes_in_its_own_way_are_refused_beside_others(tmp_path, pair):
    paths = [tmp_path / "target.e", tmp_path / "chaser.e"]
    for path, craft, frame in zip(paths, ("target", "chaser"), pair, strict=True):
        path.write_text(stk_ephemeris(FLIGHT, craft).replace("ICRF", frame))
    with pytest.raises(InputError, match=r"target\.e and .*chaser\.e are in different axes, .*: export both in ICRF"):
        read_trajectory(paths)


def test_two_files_of_date_keep_their_distance(tmp_path):
    paths = [tmp_path / "target.e", tmp_path / "chaser.e"]
    for path, craft in zip(paths, ("target", "chaser"), strict=True):
        path.write_text(stk_ephemeris(FLIGHT, craft).replace("ICRF", "TrueOfDate"))
    assert read_trajectory(paths).range_m == pytest.approx(FLIGHT.range_m, abs=1e-6)


def test_beyond_the_predictions_two_frames_are_refused_and_one_is_not(tmp_path):
    later = oriented_until().plus(30 * 86400.0).iso()
    flight = hold(HoldConfig(duration_s=300.0, step_s=60.0), FlightConfig(later))
    paths = [tmp_path / "target.e", tmp_path / "chaser.e"]
    for path, craft, frame in zip(paths, ("target", "chaser"), ("ICRF", "Fixed"), strict=True):
        path.write_text(stk_ephemeris(flight, craft).replace("ICRF", frame))
    with pytest.raises(InputError, match=r"inertial and in Earth-fixed axes at .*: export both in one frame"):
        read_trajectory(paths)
    paths[0].write_text(paths[0].read_text().replace("ICRF", "Fixed"))
    assert len(read_trajectory(paths)) == 6


def test_the_earths_orientation_is_that_of_the_iers():
    earth = earth_orientation()
    day = int(np.flatnonzero(earth.mjd == 60615.0)[0])  # 2024-11-01
    assert earth.ut1_utc_s[day] == pytest.approx(0.047, abs=0.01)
    assert np.abs(earth.ut1_utc_s).max() < 0.91
    assert np.abs(earth.polar_motion).max() < 1.0 * np.pi / 648000.0


def test_the_pole_interpolated_between_nodes_is_the_pole():
    epoch, t = parse_iso(EPOCH), np.array([0.0, 301.0, 86400.0])
    whole = q_eci_frame(ReferenceFrame("ecef"), epoch, t)[1]
    alone = q_eci_frame(ReferenceFrame("ecef"), epoch, t[1:2])[0]
    assert whole == pytest.approx(alone, abs=1e-11)
