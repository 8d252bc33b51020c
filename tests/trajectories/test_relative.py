"""Positions in a Hill frame: each spelling of one flight gives one flight, and what is left open is asked at once."""

from pathlib import Path

import numpy as np
import pytest

from proxnav.errors import InputError, InputNote
from proxnav.flight.truth_files import TrueStates, write_truth
from proxnav.geometry.relative_motion import ric_from_eci
from proxnav.records import Trajectory
from proxnav.trajectories import OrbitConfig, ReaderConfig, read_trajectory

DATA = Path(__file__).parents[1] / "data" / "trajectories"
RHO = np.loadtxt(DATA / "lvlh_plain.csv", delimiter=",", skiprows=1)
"""t, x, y, z, vx, vy, vz in RIC: the four files of one flight hold the first four columns."""


def read(path: Path, **options: object) -> Trajectory:
    with pytest.warns(InputNote):
        return read_trajectory([path], ReaderConfig(**options))  # pyright: ignore


def ric(flight: Trajectory) -> tuple[np.ndarray, np.ndarray]:
    return ric_from_eci(flight.r_eci_target_m, flight.v_eci_target_mps, flight.r_eci_chaser_m, flight.v_eci_chaser_mps)


@pytest.mark.parametrize(
    ("name", "options"),
    [("lvlh_plain.csv", {"frame": "RIC"}), ("lvlh_plain.csv", {"frame": "Hill", "position_unit": "m"}),
     ("lvlh_vbar.csv", {}), ("lvlh_vbar.csv", {"frame": "LVLH"}), ("lvlh_ric4.csv", {}),
     ("lvlh_ric4.csv", {"frame": "J2000"}), ("ml_semicolon.csv", {})],
)  # fmt: skip
def test_every_spelling_of_one_flight_gives_the_same_positions_and_rates(name, options):
    flight = read(DATA / name, **options)
    rho, rate = ric(flight)
    assert flight.t == pytest.approx(RHO[:, 0])
    assert rho == pytest.approx(RHO[:, 1:4], abs=1e-6)
    assert rate == pytest.approx(RHO[:, 4:], abs=1e-5)  # by the slope of the positions where a file has no rates


def test_lvlh_is_ahead_against_the_normal_and_to_nadir(tmp_path):
    path = tmp_path / "below.csv"
    path.write_text("t,x,y,z\n0,-30,2,5\n10,-30,2,5\n")
    rho, _ = ric(read(path, frame="LVLH"))
    assert rho[0] == pytest.approx([-5.0, -30.0, -2.0], abs=1e-6)  # 5 m below is 5 m less radius


@pytest.mark.parametrize(
    "header",
    ["t_s,r_ric_x_m,r_ric_y_m,r_ric_z_m,v_ric_x_mps,v_ric_y_mps,v_ric_z_mps,q_cam_target_w,rate_target_x_rad_s",
     "t,rho_x_ric [m],rho_y_ric,rho_z_ric,rho_dot_x_ric [m/s],rho_dot_y_ric,rho_dot_z_ric [m/s],a,b",
     "t;RTN_R (m);RTN_T (m);RTN_N (m);vR;vT;vN;a;b",
     "t\tradial\talong-track\tcross-track\tradial velocity (m/s)\tin-track velocity\tcross-track velocity\ta\tb",
     "t x_hill y_hill z_hill vx_hill vy_hill vz_hill a b"],
)  # fmt: skip
def test_columns_of_the_field_are_known_by_name_whatever_parts_them(tmp_path, header):
    mark = next((m for m in ";\t," if m in header), " ")
    path = tmp_path / "truth.csv"
    rows = [f"{t},1,-30,2,0.1,0.2,0.3,1,0.7".replace(",", mark) for t in (0, 10)]
    path.write_text("\n".join([header, *rows]) + "\n")
    rho, rate = ric(read(path))
    assert rho[0] == pytest.approx([1.0, -30.0, 2.0], abs=1e-6)
    assert rate[0] == pytest.approx([0.1, 0.2, 0.3], abs=1e-6)


def test_our_own_truth_flies_again(tmp_path):
    still = np.tile([1.0, 0.0, 0.0, 0.0], (len(RHO), 1))
    states = TrueStates(RHO[:, 0], RHO[:, 1:4], RHO[:, 4:], still, 1e-3 * RHO[:, 4:])
    write_truth(tmp_path / "truth.csv", states)
    rho, rate = ric(read(tmp_path / "truth.csv"))
    assert rho == pytest.approx(states.r_ric_m, abs=1e-6)
    assert rate == pytest.approx(states.v_ric_mps, abs=1e-9)


def test_decimal_commas_are_points_and_thousands_are_refused(tmp_path):
    path = tmp_path / "european.csv"
    path.write_text("t;radial [km];in-track [km];cross-track [km]\n0,5;0,001;-3,0e-2;,002\n1,5;0,001;-3,0e-2;0,002\n")
    rho, _ = ric(read(path))
    assert rho[0] == pytest.approx([1.0, -30.0, 2.0], abs=1e-6)
    path.write_text(path.read_text().replace("0,5;0,001", "1.000,5;0,001"))
    with pytest.raises(InputError, match=r"line 2: '1\.000,5' has a point and a comma"):
        read_trajectory([path])


def test_dates_of_european_files_are_read(tmp_path):
    path = tmp_path / "european.csv"
    path.write_text(
        "Zeit;t;radial;in-track;cross-track\nx;01.11.2024 00:30:00,5;1;-30;2\nx;01.11.2024 00:30:10,5;1;-30;2\n"
    )
    flight = read(path)
    assert flight.epoch_utc == "2024-11-01T00:30:00.5Z"
    assert flight.t == pytest.approx([0.0, 10.0])


def test_a_relative_flight_follows_the_orbit_of_a_file_or_of_the_options(tmp_path):
    with pytest.warns(InputNote, match=r"whose orbit is that of .*ok\.oem"):
        about = read_trajectory(
            [DATA / "ok.oem", DATA / "lvlh_vbar.csv"], ReaderConfig(epoch_utc="2026-01-01T00:00:00Z")
        )
    assert ric(about)[0] == pytest.approx(RHO[: len(about), 1:4], abs=1e-6)
    low = read(DATA / "lvlh_vbar.csv", target_orbit=OrbitConfig(altitude_m=300e3))
    assert np.linalg.norm(low.r_eci_target_m, axis=1) == pytest.approx(np.full(len(low), 6678137.0))
    eccentric = read(DATA / "lvlh_vbar.csv", target_elements="a=7000km e=0.01 i=98 raan=10 argp=30 nu=40")
    assert ric(eccentric)[0] == pytest.approx(RHO[:, 1:4], abs=1e-6)
    with pytest.raises(InputError, match=r"both give the target's orbit; give one"):
        read_trajectory(
            [DATA / "lvlh_vbar.csv"], ReaderConfig(target_orbit=OrbitConfig(300e3), target_elements="a=7000km")
        )


@pytest.mark.parametrize(
    ("name", "options", "said"),
    [("lvlh_plain.csv", {}, r"lvlh_plain\.csv: the file does not say the axes of x, y, z; relative to the target say "
      r"--reader\.frame RIC \(x radial outward, .*\) or LVLH \(x ahead, z to nadir\), at Earth's centre ICRF, J2000"),
     ("lvlh_vbar.csv", {"frame": "RIC"}, r"vbar_m, hbar_m, rbar_m are LVLH .* by name, --reader\.frame says RIC"),
     ("lvlh_ric4.csv", {"frame": "VVLH"}, r"r_ric_x_m, .* are RIC .* by name, --reader\.frame says VVLH"),
     ("lvlh_plain.csv", {"frame": "RIC", "position_unit": "furlong"}, r"--reader\.position-unit furlong is unknown")],
)  # fmt: skip
def test_what_is_left_open_or_contradicts_itself_is_one_sentence_that_can_be_followed(name, options, said):
    with pytest.raises(InputError, match=said) as error:
        read_trajectory([DATA / name], ReaderConfig(**options))
    assert "\n" not in str(error.value)


def test_positions_of_the_chaser_that_are_given_twice_are_refused():
    files = [DATA / name for name in ("ok.oem", "chaser.oem", "lvlh_vbar.csv")]
    with pytest.raises(
        InputError, match=r"given more than once, by lvlh_vbar of .*, CHASER of .*chaser\.oem; name one"
    ):
        read_trajectory(files, ReaderConfig(epoch_utc="2026-01-01T00:00:00Z"))
    two = [DATA / "lvlh_vbar.csv", DATA / "lvlh_ric4.csv"]
    with pytest.raises(InputError, match=r"given more than once, by lvlh_vbar of .*, lvlh_ric4 of"):
        read_trajectory(two)
    with pytest.warns(InputNote, match=r"lvlh_ric4\.csv: read as RIC"):
        assert ric(read_trajectory(two, ReaderConfig(chaser="lvlh_ric4")))[0] == pytest.approx(RHO[:, 1:4], abs=1e-6)


def test_the_note_says_axes_unit_distance_and_orbit():
    with pytest.warns(InputNote) as notes:
        read_trajectory([DATA / "ml_semicolon.csv"])
    assert [str(note.message).split(": ", 1)[1] for note in notes] == [
        "read as RIC (x radial outward, y in-track, z along r x v; also called RTN, RSW, Hill), in metres, which the "
        "file does not say: 14.14 to 54.72 m from the target, whose orbit is a circle at 400 km, 6.2 deg "
        "(--reader.target-orbit or --reader.target-elements say another)"
    ]
