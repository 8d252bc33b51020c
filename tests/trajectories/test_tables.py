"""Reports and csv files of STK, MATLAB and Basilisk: units, order and frames from the file or from the user."""

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.epochs import parse_iso
from proxnav.trajectories.readers.columns import understand
from proxnav.trajectories.readers.config import ReaderConfig
from proxnav.trajectories.readers.dates import parse_date, parse_duration
from proxnav.trajectories.readers.tabular import histories
from proxnav.trajectories.readers.text_table import read_csv, read_report

EPOCH = parse_iso("2024-11-01T00:00:00Z")

REPORT = """                                                                      10 Jul 2025 08:00:00
Satellite-SROC:  J2000 Position Velocity

       Time (UTCG)             x (km)         y (km)      z (km)    vx (km/sec)    vy (km/sec)    vz (km/sec)
------------------------    -----------    ----------    --------    -----------    -----------    -----------
 1 Nov 2024 00:00:00.000    7000.000000      0.000000    0.000000       0.000000       7.500000       0.000000
 1 Nov 2024 00:01:00.000    6985.000000    449.700000    0.000000      -0.500000       7.480000       0.000000
"""

STATES = "t,x_1,y_1,z_1,vx_1,vy_1,vz_1\n0,7000,0,0,0,7.5,0\n60,6985,449.7,0,-0.5,7.48,0\n"


def csv_file(tmp_path, text, name="table.csv"):
    path = tmp_path / name
    path.write_bytes(text.encode())
    return path


def read(tmp_path, text, columns=(), **options):
    table = read_csv(csv_file(tmp_path, text), tuple(columns))
    return histories(table, ReaderConfig(columns=tuple(columns), **options))


def test_an_stk_report_brings_its_units_frame_epoch_and_object(tmp_path):
    (orbit,) = histories(read_report(csv_file(tmp_path, REPORT, "report.txt")), ReaderConfig())
    assert (orbit.name, orbit.frame.kind, orbit.epoch) == ("SROC", "j2000", EPOCH)
    assert orbit.segments[0].t.tolist() == [0.0, 60.0]
    assert orbit.segments[0].values[0].tolist() == [7e6, 0.0, 0.0]
    assert orbit.segments[0].rates[1].tolist() == [-500.0, 7480.0, 0.0]


def test_a_csv_with_byte_order_mark_windows_lines_and_repeated_header_reads(tmp_path):
    head = '"Time (UTCG)","x (m)","y (m)","z (m)"\r\n'
    rows = ["1 Nov 2024 00:00:00.000,7000000.0,0.0,0.0\r\n", "1 Nov 2024 00:01:00.000,7000000.0,1.0,0.0\r\n"]
    (orbit,) = read(tmp_path, "\ufeff" + head + rows[0] + "\r\n" + head + rows[1], frame="Fixed")
    assert orbit.frame.kind == "ecef"
    assert orbit.segments[0].values[:, 1].tolist() == [0.0, 1.0]
    assert orbit.segments[0].rates is None


def test_objects_are_told_apart_by_prefix_or_suffix(tmp_path):
    prefixed = (
        "Time (EpSec),sat1 - x (km),sat1 - y (km),sat1 - z (km),sat2 - x (km),sat2 - y (km),sat2 - z (km)\n"
        "0,7000,0,0,7001,0,0\n60,7000,450,0,7001,450,0\n"
    )
    found = read(tmp_path, prefixed, frame="J2000")
    assert [(h.name, h.segments[0].values[0, 0]) for h in found] == [("sat1", 7e6), ("sat2", 7.001e6)]
    suffixed = "t,x_a,y_a,z_a,x_b,y_b,z_b\n0,7000,0,0,7001,0,0\n60,7000,450,0,7001,450,0\n"
    found = read(tmp_path, suffixed, frame="J2000", position_unit="km")
    assert [h.name for h in found] == ["a", "b"]


def test_the_missing_suffix_of_basilisks_header_is_mended(shared_data):
    table = read_csv(shared_data / "basilisk" / "scHoldTraj_rotating_EP.csv", ())
    column = next(column for column in understand(table.headers) if column.header == "Beta1")
    assert (column.meaning, column.owner) == ("qx", "1")
    found = histories(table, ReaderConfig())
    assert [(type(h).__name__, h.name) for h in found] == [
        ("OrbitHistory", "1"), ("AttitudeHistory", "1"), ("OrbitHistory", "2"), ("AttitudeHistory", "2")
    ]  # fmt: skip
    assert "trust neither" in found[1].note  # craft 1's quaternions are craft 2's
    assert found[3].note == ""


def test_matlab_quaternions_are_passive_scalar_first(tmp_path):
    text = "t,q1,q2,q3,q4\n0,0.70710678,0,0.70710678,0\n10,0.70710678,0,0.70710678,0\n"
    (attitude,) = read(tmp_path, text, frame="J2000", quaternion_order="wxyz")
    quat2dcm = [[0, 0, -1], [0, 1, 0], [1, 0, 0]]  # of [1 0 1 0], as MATLAB documents it: reference to body
    assert pytest.approx(np.array(quat2dcm), abs=1e-9) == quaternion.to_matrix(attitude.segments[0].values[0]).T
    (reverse,) = read(tmp_path, text, frame="J2000", quaternion_order="wxyz", quaternion_direction="body_to_reference")
    assert quaternion.to_matrix(reverse.segments[0].values[0]) == pytest.approx(np.array(quat2dcm), abs=1e-9)


@pytest.mark.parametrize("header", ["t,qx,qy,qz,qw", "t,beta1,beta2,beta3,beta0", "t,q1,q2,q3,q0"])
def test_named_scalars_need_no_order(tmp_path, header):
    (attitude,) = read(tmp_path, f"{header}\n0,0,0,0.6,0.8\n10,0,0,0.6,0.8\n", frame="J2000")
    assert attitude.segments[0].values[0] == pytest.approx([0.8, 0.0, 0.0, 0.6])


def test_a_file_without_header_is_named_by_the_user(tmp_path):
    text = "0,7000,0,0\n60,7000,450,0\n"
    with pytest.raises(InputError, match=r"no header; name the 4 columns, for example --reader.columns"):
        read(tmp_path, text)
    (orbit,) = read(tmp_path, text, ("t", "x", "y", "z"), position_unit="km", frame="J2000")
    assert orbit.segments[0].values[1, 1] == 450e3


def test_matlab_variable_names_may_carry_units(tmp_path):
    text = "Time,x_km_,y_km_,z_km_,vx_km_s,vy_km_s,vz_km_s\n01-Nov-2024 00:00:00,7000,0,0,0,7.5,0\n"
    (orbit,) = read(tmp_path, text + "01-Nov-2024 00:01:00,7000,450,0,0,7.5,0\n", frame="J2000")
    assert orbit.epoch == EPOCH
    assert orbit.segments[0].rates[0, 1] == 7500.0


@pytest.mark.parametrize(
    ("cells", "seconds"),
    [(("00:00:05", "00:01:05"), 60.0), (("5 sec", "65 sec"), 60.0),
     (("2024-11-01T00:00:00", "2024-11-01T00:00:09"), 9.0),
     (("2024/11/01 00:00:00", "2024/11/01 00:00:09"), 9.0), (("306/24 00:00:00", "306/2024 00:00:09"), 9.0)],
)  # fmt: skip
def test_times_are_dates_or_durations(tmp_path, cells, seconds):
    text = f"Time,x (km),y (km),z (km)\n{cells[0]},7000,0,0\n{cells[1]},7000,450,0\n"
    (orbit,) = read(tmp_path, text, frame="J2000")
    assert np.diff(orbit.segments[0].t) == pytest.approx([seconds], abs=1e-6)


def test_julian_dates_are_dates(tmp_path):
    text = "Time (JDate),x (km),y (km),z (km)\n2460615.5,7000,0,0\n2460616.0,7000,450,0\n"
    (orbit,) = read(tmp_path, text, frame="J2000")
    assert abs(orbit.epoch - EPOCH) < 1e-4
    assert orbit.segments[0].t[1] == pytest.approx(43200.0, abs=1e-4)


def test_relative_positions_are_recognised(tmp_path):
    text = "Time (EpSec),Radial (m),In-Track (m),Cross-Track (m)\n0,1,-30,2\n10,1,-29,2\n"
    (orbit,) = read(tmp_path, text)
    assert orbit.frame.kind == "ric"
    assert orbit.segments[0].values[0].tolist() == [1.0, -30.0, 2.0]


@pytest.mark.parametrize(
    ("old", "new", "options", "message"),
    [
        ("", "", {"frame": "J2000"}, "column x_1 has no unit; say --reader.position-unit m or km"),
        ("", "", {"frame": "J2000", "position_unit": "km"}, "vx_1 has no unit; say --reader.velocity-unit m/s or km/s"),
        ("", "", {"frame": "J2000", "position_unit": "furlong"}, "--reader.position-unit furlong is unknown"),
        (
            "",
            "",
            {},
            r"does not say the axes of x_1, y_1, z_1; .* --reader.frame RIC .* or LVLH .*, at Earth's centre ICRF",
        ),
        ("", "", {"frame": "Moon"}, "--reader.frame Moon is unknown; use RIC, RTN, RSW, Hill, LVLH .* ICRF, J2000"),
        ("x_1", "x_1 (parsec)", {"frame": "J2000"}, r"line 1: unknown unit 'parsec' of column x_1 \(parsec\)"),
        ("60,6985,449.7,0,-0.5,7.48,0", "60,6985,449.7", {}, "line 3: 3 cells under 7 columns; the line may be cut"),
        ("60,", "-60,", {}, "line 3: time goes backwards from 0 s to -60 s"),
        ("449.7", "", {}, "line 3: the cell of column y_1 is empty"),
        ("449.7", "abc", {"frame": "J2000", "position_unit": "km"}, "line 3: expected a number under y_1, found 'abc'"),
        (
            "449.7",
            "NaN",
            {"frame": "J2000", "position_unit": "km"},
            "line 3: expected a number under y_1, found 'NaN', which is not",
        ),
        (
            "x_1,y_1",
            "alpha,beta",
            {},
            "no position nor quaternion among the columns t, alpha, .* name all with --reader.columns: t and x y z",
        ),
        ("t,", "Time (fortnight),", {}, "line 2: unknown time unit 'fortnight'"),
        ("0,7000", "1 Nov 2024 00:00,7000", {}, "line 3: .*'60' is not ISO 8601"),
    ],
)
def test_a_table_that_is_silent_or_damaged_asks_one_sentence(tmp_path, old, new, options, message):
    with pytest.raises(InputError, match=message) as error:
        read(tmp_path, STATES.replace(old, new, 1) if old else STATES, **options)
    assert "\n" not in str(error.value)


def test_quaternions_without_declared_order_are_not_guessed(tmp_path):
    with pytest.raises(InputError, match="columns q1 to q4 do not say where the scalar is"):
        read(tmp_path, "t,q1,q2,q3,q4\n0,1,0,0,0\n", frame="J2000")
    with pytest.raises(InputError, match=r"line 2: the quaternion .* has norm 0\.5"):
        read(tmp_path, "t,q1,q2,q3,q4\n0,0.5,0,0,0\n", frame="J2000", quaternion_order="wxyz")


def test_a_report_without_header_is_refused(tmp_path):
    with pytest.raises(InputError, match="no header over a dashed line"):
        read_report(csv_file(tmp_path, REPORT.replace("-", " "), "report.txt"))


@pytest.mark.parametrize("text", ["32 Nov 2024 00:00:00", "1 Brumaire 2024 00:00:00", "1 Nov 2024 25:00:00"])
def test_dates_that_do_not_exist_are_refused(text):
    with pytest.raises(InputError, match="does not exist"):
        parse_date(text)


def test_durations_are_told_from_other_text():
    assert [parse_duration(text) for text in ("1:02:03:04", "90 min", "12", "soon")] == [93784.0, 5400.0, None, None]
