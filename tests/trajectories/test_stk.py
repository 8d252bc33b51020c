"""STK ephemeris and attitude files: every data block, unit, frame and trap, with hand-computed cases."""

import numpy as np
import pytest

from proxnav.errors import InputError, InputNote
from proxnav.geometry import quaternion
from proxnav.geometry.celestial import geodetic_to_ecef, q_eci_ecef, q_eci_mod
from proxnav.geometry.epochs import parse_iso
from proxnav.trajectories.orbit import OrbitConfig, fly_orbit
from proxnav.trajectories.readers.history import sample_attitude, sample_orbit
from proxnav.trajectories.readers.reference_frames import q_eci_frame
from proxnav.trajectories.readers.stk_attitude import read_stk_attitude
from proxnav.trajectories.readers.stk_ephemeris import read_stk_ephemeris

EPOCH = parse_iso("2024-11-01T00:00:00Z")
X, Y, Z = np.eye(3)
ICRF = ("CoordinateAxes ICRF",)


def ephemeris(tmp_path, rows, block="EphemerisTimePosVel", head=("CoordinateSystem ICRF",), name="craft.e", tail=()):
    lines = ["stk.v.11.0", "BEGIN Ephemeris", "ScenarioEpoch 1 Nov 2024 00:00:00.0", *head, block]
    lines += [" ".join(f"{value:.15e}" for value in row) for row in rows]
    path = tmp_path / name
    path.write_text("\n".join([*lines, *tail, "END Ephemeris", ""]))
    return path


def attitude(tmp_path, block, rows, head=("CoordinateAxes ICRF",)):
    lines = ["stk.v.8.0", "BEGIN Attitude", "ScenarioEpoch 1 Nov 2024 00:00:00.0", *head, block]
    lines += [" ".join(str(value) for value in row) for row in rows]
    path = tmp_path / "craft.a"
    path.write_text("\n".join([*lines, "END Attitude", ""]))
    return path


def orbit_rows(step, count=40):
    t = step * np.arange(count)
    r, v = fly_orbit(OrbitConfig(inclination_deg=40.0), t)
    return np.column_stack([t, r, v])


def q_at(history, t):
    return sample_attitude(history, EPOCH, np.array([float(t)]))[0]


def body_axis(history, axis, t=0.0):
    return quaternion.rotate(q_at(history, t), axis)


def test_the_external_satellite_starts_at_6678_137_km(shared_data):
    history = read_stk_ephemeris(shared_data / "stk" / "SatelliteTests_External_Satellite1.e")
    assert history.epoch == parse_iso("2009-09-09T16:00:00Z")
    t = np.concatenate([segment.t for segment in history.segments])
    assert (len(t), t[1] - t[0]) == (1441, 60.0)
    r, v = sample_orbit(history, history.epoch, t)
    assert np.linalg.norm(r[0]) == pytest.approx(6678137.0, abs=1e-3)
    assert np.abs(np.linalg.norm(r, axis=1) - 6678137.0).max() < 10.0
    between = sample_orbit(history, history.epoch, t[10:-10] + 30.0)[0]
    assert np.abs(np.linalg.norm(between, axis=1) - 6678137.0).max() < 10.0
    assert np.linalg.norm(v[0]) == pytest.approx(np.hypot(6789.53030027267, 3686.41417440091))


def test_geodetic_positions_are_earth_fixed(shared_data):
    history = read_stk_ephemeris(shared_data / "stk" / "Id392.e")
    assert (history.frame.kind, history.nodes, len(history.segments[0].t)) == ("ecef", 2, 5)
    r, _ = sample_orbit(history, history.epoch, np.array([0.0, 1800.0]))
    q = q_eci_frame(history.frame, parse_iso("2007-07-01T12:00:00Z"), np.array([0.0, 1800.0]))
    fixed = quaternion.rotate(quaternion.conjugate(q), r)
    corners = geodetic_to_ecef(np.deg2rad([10.0, 10.0]), np.deg2rad([-16.0, -14.0]), np.array([1000.0, 1000.0]))
    assert fixed[0] == pytest.approx(corners[0], abs=1e-3)
    assert fixed[1] == pytest.approx(corners.mean(axis=0), abs=1e-3)  # InterpolationSamplesM1 1 is linear


def test_geodetic_rates_are_the_derivatives_of_positions(tmp_path):
    rates = (0.05, -0.06, 3.0)  # deg/s, deg/s, m/s
    rows = [(t, 30.0 + rates[0] * t, -40.0 + rates[1] * t, 4e5 + rates[2] * t, *rates) for t in (0.0, 1e-2, 2e-2)]
    segment = read_stk_ephemeris(ephemeris(tmp_path, rows, "EphemerisLLATimePosVel")).segments[0]
    assert segment.rates[1] == pytest.approx((segment.values[2] - segment.values[0]) / 2e-2, abs=1e-3)


def test_defaults_are_metres_earth_fixed_and_six_points(tmp_path):
    history = read_stk_ephemeris(ephemeris(tmp_path, orbit_rows(60.0), head=()))
    assert (history.frame.kind, history.nodes, history.method) == ("ecef", 6, "lagrange")
    assert history.segments[0].values[0] == pytest.approx(orbit_rows(60.0)[0, 1:4])


def test_earth_fixed_velocities_gain_earths_turn(tmp_path):
    rows = [(t, 6778e3, 0.0, 0.0, 0.0, 0.0, 0.0) for t in (0.0, 60.0)]
    _, v = sample_orbit(read_stk_ephemeris(ephemeris(tmp_path, rows, head=())), EPOCH, np.array([0.0]))
    assert np.linalg.norm(v) == pytest.approx(6778e3 * 7.292115e-5)


def test_distance_unit_and_case_of_keywords(tmp_path):
    rows = orbit_rows(60.0) / [1.0, *[1e3] * 6]
    head = ("coordinatesystem j2000", "DISTANCEUNIT kilometers", "", "\t")
    history = read_stk_ephemeris(ephemeris(tmp_path, rows, head=head))
    assert history.segments[0].values[3] == pytest.approx(orbit_rows(60.0)[3, 1:4])
    assert history.segments[0].rates[3] == pytest.approx(orbit_rows(60.0)[3, 4:])


@pytest.mark.parametrize("system", ["MeanOfDate", "TrueOfDate"])
def test_frames_of_date_are_precessed(tmp_path, system):
    history = read_stk_ephemeris(ephemeris(tmp_path, orbit_rows(60.0), head=(f"CoordinateSystem {system}",)))
    r, _ = sample_orbit(history, EPOCH, np.array([0.0]))
    expected = quaternion.rotate(q_eci_mod("2024-11-01T00:00:00Z", np.array([0.0])), orbit_rows(60.0)[:1, 1:4])
    assert r == pytest.approx(expected)


def test_the_error_of_lagrange_interpolation_falls_with_the_sixth_power_of_the_step(tmp_path):
    errors = []
    for step in (240.0, 120.0):
        rows = orbit_rows(step)[:, :4]
        history = read_stk_ephemeris(ephemeris(tmp_path, rows, "EphemerisTimePos"))
        t = step * (np.arange(10, 20) + 0.5)
        truth = fly_orbit(OrbitConfig(inclination_deg=40.0), t)
        r, v = sample_orbit(history, EPOCH, t)
        errors.append(np.abs(r - truth[0]).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(6.0, abs=0.3)
    assert np.abs(v - truth[1]).max() < 0.05  # m/s, from positions alone


def test_hermite_interpolation_uses_the_velocities(tmp_path):
    head = ("CoordinateSystem ICRF", "InterpolationMethod Hermite", "InterpolationSamplesM1 3")
    history = read_stk_ephemeris(ephemeris(tmp_path, orbit_rows(120.0), head=head))
    t = 120.0 * (np.arange(10, 20) + 0.5)
    r, v = sample_orbit(history, EPOCH, t)
    truth = fly_orbit(OrbitConfig(inclination_deg=40.0), t)
    assert np.abs(r - truth[0]).max() < 1e-3  # m
    assert np.abs(v - truth[1]).max() < 1e-4  # m/s


def test_nothing_is_interpolated_across_a_segment_boundary(tmp_path):
    t = np.array([0.0, 10.0, 20.0, 30.0, 30.0, 40.0, 50.0, 60.0])
    x = np.where(np.arange(8) < 4, 7e6 + 10.0 * t, 7e6 + 300.0 - 5.0 * (t - 30.0))  # a kink: a manoeuvre at 30 s
    rows = np.column_stack([t, x, 0 * t, 0 * t])
    boundary = ("BEGIN SegmentBoundaryTimes", "0.0 30.0", "60.0", "END SegmentBoundaryTimes")
    path = ephemeris(tmp_path, rows, "EphemerisTimePos", tail=("", *boundary))
    history = read_stk_ephemeris(path)
    assert len(history.segments) == 2
    r, v = sample_orbit(history, EPOCH, np.array([29.0, 30.0, 31.0]))
    assert r[:, 0] == pytest.approx([7e6 + 290.0, 7e6 + 300.0, 7e6 + 295.0], abs=1e-6)
    assert v[:, 0] == pytest.approx([10.0, -5.0, -5.0], abs=1e-6)


def test_a_boundary_without_a_repeated_row_splits_there(tmp_path):
    t = np.arange(0.0, 70.0, 10.0)
    x = np.where(t <= 30.0, 7e6 + 10.0 * t, 7e6 + 300.0 - 5.0 * (t - 30.0))
    boundary = ("BEGIN SegmentBoundaryTimes", "30.0", "END SegmentBoundaryTimes")
    rows = np.column_stack([t, x, 0 * t, 0 * t])
    history = read_stk_ephemeris(ephemeris(tmp_path, rows, "EphemerisTimePos", tail=boundary))
    assert [len(segment.t) for segment in history.segments] == [4, 4]
    assert sample_orbit(history, EPOCH, np.array([35.0]))[0][0, 0] == pytest.approx(7e6 + 275.0)


def test_fewer_rows_than_declared_are_all_read_with_a_note_where_the_block_ends_as_it_should(tmp_path):
    path = ephemeris(tmp_path, orbit_rows(60.0), head=("CoordinateSystem ICRF", "NumberOfEphemerisPoints 99"))
    with pytest.warns(InputNote, match="numberofephemerispoints is 99, the 40 rows that there are before END are read"):
        assert len(read_stk_ephemeris(path).segments[0].t) == 40
    path.write_text(path.read_text().replace("END Ephemeris", ""))
    with pytest.raises(InputError, match="the file is cut off"):
        read_stk_ephemeris(path)


def test_lvlh_of_stk_has_x_outward_and_its_vvlh_has_z_to_nadir(tmp_path):
    kinds = {}
    for axes in ("LVLH", "VVLH", "RIC"):
        path = attitude(tmp_path, "AttitudeTimeQuaternions", [(0.0, 0, 0, 0, 1)], (f"CoordinateAxes {axes}",))
        kinds[axes] = read_stk_attitude(path).frame.kind
    assert kinds == {"LVLH": "ric", "VVLH": "lvlh", "RIC": "ric"}  # as STK's Vector Geometry Tool defines them


def test_a_covariance_block_is_noted(tmp_path):
    tail = ("CovarianceTimePos", "0.0 1 0 1 0 0 1")
    assert (
        read_stk_ephemeris(ephemeris(tmp_path, orbit_rows(60.0), tail=tail)).note == "its covariance block is not used"
    )


def test_more_rows_than_declared_are_cut_with_a_warning(tmp_path):
    path = ephemeris(tmp_path, orbit_rows(60.0), head=("CoordinateSystem ICRF", "NumberOfEphemerisPoints 30"))
    with pytest.warns(UserWarning, match="the 10 rows after that are ignored"):
        assert len(read_stk_ephemeris(path).segments[0].t) == 30


def test_accelerations_and_covariances_are_passed_over(tmp_path):
    rows = np.column_stack([orbit_rows(60.0), np.ones((40, 3))])
    tail = ("CovarianceTimePos", "0.0 1 0 1 0 0 1", "60.0 1 0 1 0 0 1")
    history = read_stk_ephemeris(ephemeris(tmp_path, rows, "EphemerisTimePosVelAcc", tail=tail))
    assert len(history.segments[0].t) == 40


@pytest.mark.parametrize(
    "text", ['"1 Nov 2024 00:00:00.00"', "1 November 2024 00:00:00", "2024-11-01T00:00:00Z", "30615.5"]
)
def test_spellings_of_the_epoch(tmp_path, text):
    path = ephemeris(tmp_path, orbit_rows(60.0))
    path.write_text(path.read_text().replace("1 Nov 2024 00:00:00.0", text))
    assert read_stk_ephemeris(path).epoch == EPOCH


SIXTY = quaternion.exp(np.deg2rad(60.0) * Z)


@pytest.mark.parametrize(
    ("block", "row", "head"),
    [
        ("AttitudeTimeQuaternions", (0, 0, 0.5, 0.8660254), ()),
        ("AttitudeTimeQuatScalarFirst", (0.8660254, 0, 0, 0.5), ()),
        ("AttitudeTimeQuatAngVels", (0, 0, 0.5, 0.8660254, 0, 0, 0), ()),
        ("AttitudeTimeEulerAngles", (60, 0, 0), ()),
        ("AttitudeTimeEulerAngles", (60, 0, 0), ("Sequence 321",)),
        ("AttitudeTimeYPRAngles", (60, 0, 0), ()),
        ("AttitudeTimeYPRAngles", (60, 0, 0), ("Sequence 231",)),
        ("AttitudeTimeDCM", (0.5, 0.8660254, 0, -0.8660254, 0.5, 0, 0, 0, 1), ()),
    ],
)
def test_every_block_of_agis_example_is_a_turn_by_sixty_degrees_about_z(tmp_path, block, row, head):
    path = attitude(tmp_path, block, [(0.0, *row), (10.0, *row)], ("CoordinateAxes ICRF", *head))
    assert quaternion.angle_between(q_at(read_stk_attitude(path), 5.0), SIXTY) < 1e-6


def test_yaw_pitch_roll_turn_about_the_reference_axes_and_euler_angles_about_moved_ones(tmp_path):
    rows = [(0.0, 90.0, 90.0, 0.0)]
    ypr = read_stk_attitude(attitude(tmp_path, "AttitudeTimeYPRAngles", rows, ICRF))
    assert body_axis(ypr, X) == pytest.approx(Y, abs=1e-9)  # yaw takes x to y, pitch about the fixed y leaves it
    euler = read_stk_attitude(attitude(tmp_path, "AttitudeTimeEulerAngles", rows, (*ICRF, "Sequence 321")))
    assert body_axis(euler, X) == pytest.approx(-Z, abs=1e-9)  # pitch about the yawed y takes it down
    nodal = read_stk_attitude(attitude(tmp_path, "AttitudeTimeEulerAngles", rows, ICRF))
    assert body_axis(nodal, Z) == pytest.approx(X, abs=1e-9)  # 313: inclination 90 deg, node at y


def test_columns_of_yaw_pitch_roll_keep_their_order_whatever_the_sequence(tmp_path):
    path = attitude(tmp_path, "AttitudeTimeYPRAngles", [(0.0, 0.0, 0.0, 90.0)], (*ICRF, "Sequence 123"))
    assert body_axis(read_stk_attitude(path), Y) == pytest.approx(Z, abs=1e-9)


def test_earth_fixed_axes_turn_with_earth(tmp_path):
    rows = [(0.0, 0, 0, 0, 1), (3600.0, 0, 0, 0, 1)]
    path = attitude(tmp_path, "AttitudeTimeQuaternions", rows, ("CoordinateAxes Fixed",))
    expected = q_eci_ecef("2024-11-01T00:00:00Z", np.array([1800.0]))[0]  # without nutation, which is up to 9e-5 rad
    assert quaternion.angle_between(q_at(read_stk_attitude(path), 1800.0), expected) < 9e-5


def test_the_sample_attitude_file_reads(shared_data):
    history = read_stk_attitude(shared_data / "stk" / "SatelliteTests_Satellite1.a")
    assert history.epoch == parse_iso("1999-07-01T00:00:00Z")
    assert (history.nodes, history.note, history.segments[0].t[-1]) == (3, "", 93600.0)
    q = sample_attitude(history, history.epoch, np.array([1000.0]))
    assert q == pytest.approx(np.array([[1.0, 0, 0, 0]]), abs=6e-8)  # J2000 differs from ICRF by 0.02 arcsec


@pytest.mark.parametrize(
    ("time_format", "times"),
    [
        ("UTCG", ("1 Nov 2024 00:00:00.0", "1 Nov 2024 00:00:10.0")),
        ("ISO-YMD", ("2024-11-01T00:00:00", "2024-11-01T00:00:10")),
    ],
)
def test_dates_may_stand_for_seconds(tmp_path, time_format, times):
    rows = [(times[0], 0, 0, 0, 1), (times[1], 0, 0, 1, 0)]
    path = attitude(tmp_path, "AttitudeTimeQuaternions", rows, ("CoordinateAxes ICRF", f"TimeFormat {time_format}"))
    turn = q_at(read_stk_attitude(path), 5.0)
    assert np.degrees(np.linalg.norm(quaternion.log(turn))) == pytest.approx(90.0)


def test_a_declared_order_interpolates_by_polynomials_and_survives_sign_flips(tmp_path):
    t = np.arange(0.0, 100.0, 10.0)
    q = quaternion.exp(0.03 * t[:, None] ** 1.5 / 10.0 * Z)
    q[1::2] *= -1.0
    rows = [(a, *b[1:], b[0]) for a, b in zip(t, q, strict=True)]
    path = attitude(tmp_path, "AttitudeTimeQuaternions", rows, ("CoordinateAxes ICRF", "InterpolationOrder 5"))
    truth = quaternion.exp(0.03 * 45.0**1.5 / 10.0 * Z)
    assert quaternion.angle_between(q_at(read_stk_attitude(path), 45.0), truth) < 2e-5


def test_rates_that_disagree_with_the_quaternions_are_noted(tmp_path):
    t = np.arange(0.0, 50.0, 10.0)
    q = quaternion.exp(np.deg2rad(0.5) * t[:, None] * Z)
    for rate, silent in ((0.5, True), (0.7, False)):
        rows = [(a, *b[1:], b[0], 0.0, 0.0, rate) for a, b in zip(t, q, strict=True)]
        assert (read_stk_attitude(attitude(tmp_path, "AttitudeTimeQuatAngVels", rows)).note == "") == silent


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("stk.v.11.0", "", "expected the banner"),
        ("END Ephemeris", "", "END Ephemeris is missing: the file is cut off"),
        ("ScenarioEpoch 1 Nov 2024 00:00:00.0", "", "ScenarioEpoch is missing"),
        ("1 Nov 2024", "31 Feb 2024", "line 3: date .* does not exist"),
        ("ICRF", "B1950", r"line 4: unknown coordinatesystem 'B1950'"),
        ("ICRF", "ICRF\nDistanceUnit Parsec", r"line 5: unknown DistanceUnit 'Parsec'"),
        ("ICRF", "ICRF\nCentralBody Moon", r"line 5: CentralBody is Moon"),
        ("ICRF", "ICRF\nInterpolationMethod Cubic", r"line 5: unknown InterpolationMethod"),
        ("ICRF", "ICRF\nNumberOfEphemerisPoints 0", "says 0 points, found 40"),
        ("EphemerisTimePosVel", "EphemerisTimeFoo", "numbers outside a data block"),
        ("1.200000000000000e+02 ", "3.0 ", r"line 8: time goes backwards from 60 s to 3 s"),
        ("1.200000000000000e+02 ", "", r"line 8: a row of ephemeristimeposvel needs 7 numbers, found 6"),
        ("1.200000000000000e+02 ", "1.2x ", r"line 8: expected a number, found '1\.2x'"),
        ("1.200000000000000e+02 ", "nan ", r"line 8: expected a number, found 'nan', which is not finite"),
    ],
)
def test_a_damaged_ephemeris_is_one_sentence_that_names_the_place(tmp_path, old, new, message):
    path = ephemeris(tmp_path, orbit_rows(60.0))
    path.write_text(path.read_text().replace(old, new, 1))
    with pytest.raises(InputError, match=message) as error:
        read_stk_ephemeris(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("block", "row", "head", "message"),
    [
        ("AttitudeTimeQuaternions", (0, 0, 0, 0.9), (), r"line 6: the quaternion .* has norm 0\.9"),
        ("AttitudeTimeQuaternions", (0, 0, 1), (), r"line 6: .* needs 4 numbers, found 3"),
        ("AttitudeTimeDCM", (1, 0, 0, 0, 1, 0, 0, 0, -1), (), "line 6: the 9 numbers are no rotation matrix"),
        ("AttitudeTimeEulerAngles", (1, 2, 3), ("Sequence 331",), "line 5: Sequence '331'"),
        ("AttitudeTimeYPRAngles", (1, 2, 3), ("Sequence 313",), "line 5: Sequence '313'"),
        ("AttitudeTimeQuaternions", (0, 0, 0, 1), ("TimeFormat JDate",), "unknown TimeFormat 'JDate'"),
        ("AttitudeTimeECIVector", (1, 0, 0), (), "leaves the turn about it open"),
    ],
)
def test_a_damaged_attitude_file_is_one_sentence(tmp_path, block, row, head, message):
    path = attitude(tmp_path, block, [(0.0, *row)], ("CoordinateAxes ICRF", *head))
    with pytest.raises(InputError, match=message):
        read_stk_attitude(path)


def test_an_overridden_scalar_order_reads_writers_that_ignore_the_blocks_order(tmp_path):
    path = attitude(tmp_path, "AttitudeTimeQuaternions", [(0.0, 0.8660254, 0, 0, 0.5)])
    assert quaternion.angle_between(q_at(read_stk_attitude(path, scalar_first=True), 0.0), SIXTY) < 1e-6


def test_times_outside_the_file_are_refused_with_its_span(tmp_path):
    history = read_stk_ephemeris(ephemeris(tmp_path, orbit_rows(60.0)))
    with pytest.raises(InputError, match="covers 2024-11-01T00:00:00Z to 2024-11-01T00:39:00Z"):
        sample_orbit(history, EPOCH, np.array([1e5]))
