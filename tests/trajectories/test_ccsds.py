"""CCSDS OEM and AEM, and their CIC variants."""

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.epochs import parse_iso
from proxnav.trajectories.readers.ccsds import read_aem, read_oem
from proxnav.trajectories.readers.history import sample_attitude, sample_orbit

OEM = """CCSDS_OEM_VERS = 2.0
CREATION_DATE = 2024-10-31T00:00:00
ORIGINATOR = TEST
META_START
OBJECT_NAME = SROC
OBJECT_ID = 2024-001A
CENTER_NAME = EARTH
REF_FRAME = ICRF
TIME_SYSTEM = UTC
START_TIME = 2024-11-01T00:00:00
STOP_TIME = 2024-11-01T00:00:20
META_STOP
COMMENT first leg
2024-11-01T00:00:00.000 7000.0 0.0 0.0 0.0 1.0 0.0
2024-306T00:00:10.000 7000.0 10.0 0.0 0.0 1.0 0.0
2024-11-01T00:00:20.000 7000.0 20.0 0.0 0.0 1.0 0.0
COVARIANCE_START
EPOCH = 2024-11-01T00:00:00
1.0
0.0 1.0
COVARIANCE_STOP
META_START
OBJECT_NAME = SROC
CENTER_NAME = EARTH
REF_FRAME = ICRF
TIME_SYSTEM = UTC
STOP_TIME = 2024-11-01T00:00:40
META_STOP
2024-11-01T00:00:20.000 7000.0 20.0 0.0 0.0 -1.0 0.0
2024-11-01T00:00:40.000 7000.0 0.0 0.0 0.0 -1.0 0.0
"""

AEM = """CCSDS_AEM_VERS = 1.0
CREATION_DATE = 2024-10-31T00:00:00
ORIGINATOR = TEST
META_START
OBJECT_NAME = SROC
REF_FRAME_A = ICRF
REF_FRAME_B = SC_BODY_1
ATTITUDE_DIR = A2B
TIME_SYSTEM = UTC
ATTITUDE_TYPE = QUATERNION
QUATERNION_TYPE = LAST
META_STOP
DATA_START
2024-11-01T00:00:00 0.0 0.0 0.5 0.8660254037844386
2024-11-01T00:00:10 0.0 0.0 0.5 0.8660254037844386
DATA_STOP
"""

EPOCH = parse_iso("2024-11-01T00:00:00Z")
SIXTY = quaternion.exp(np.array([0.0, 0.0, np.pi / 3.0]))


def write(tmp_path, text):
    path = tmp_path / "message.txt"
    path.write_text(text)
    return path


def q_of(path, **options):
    (history,) = read_aem(path, **options)
    return sample_attitude(history, EPOCH, np.array([5.0]))[0]


def test_states_are_kilometres_and_segments_stay_apart(tmp_path):
    (history,) = read_oem(write(tmp_path, OEM))
    assert (history.name, history.epoch, len(history.segments)) == ("SROC", EPOCH, 2)
    r, v = sample_orbit(history, EPOCH, np.array([5.0, 20.0, 30.0]))
    assert r == pytest.approx(np.array([[7e6, 5e3, 0.0], [7e6, 20e3, 0.0], [7e6, 10e3, 0.0]]))
    assert v[:, 1] == pytest.approx([1e3, -1e3, -1e3])


def test_covariance_matrices_are_noted_and_not_used(tmp_path):
    (history,) = read_oem(write(tmp_path, OEM))
    assert history.note == "its 1 covariance matrices are not used"
    plain = OEM.split("COVARIANCE_START")[0] + OEM.split("COVARIANCE_STOP\n")[1]
    assert read_oem(write(tmp_path, plain))[0].note == ""


@pytest.mark.parametrize(("system", "ahead_s"), [("TAI", 37.0), ("GPS", 18.0), ("TT", 69.184)])
def test_epochs_of_other_time_systems_become_utc(tmp_path, system, ahead_s):
    (orbit,) = read_oem(write(tmp_path, OEM.replace("TIME_SYSTEM = UTC", f"TIME_SYSTEM = {system}")))
    assert EPOCH - orbit.epoch == pytest.approx(ahead_s, abs=1e-9)
    assert orbit.segments[0].t.tolist() == [0.0, 10.0, 20.0]
    (attitude,) = read_aem(write(tmp_path, AEM.replace("TIME_SYSTEM = UTC", f"TIME_SYSTEM = {system}")))
    assert EPOCH - attitude.epoch == pytest.approx(ahead_s, abs=1e-9)


def test_several_objects_in_one_message_are_several_histories(tmp_path):
    text = OEM.replace("OBJECT_NAME = SROC\nCENTER_NAME", "OBJECT_NAME = RIDER\nCENTER_NAME")
    assert [history.name for history in read_oem(write(tmp_path, text))] == ["SROC", "RIDER"]


@pytest.mark.parametrize(
    ("declared", "method", "nodes"),
    [("", "hermite", 4), ("INTERPOLATION = LAGRANGE\nINTERPOLATION_DEGREE = 7", "lagrange", 8),
     ("INTERPOLATION = HERMITE\nINTERPOLATION_DEGREE = 5", "hermite", 3), ("INTERPOLATION = LINEAR", "lagrange", 2)],
)  # fmt: skip
def test_the_declared_interpolation_is_used(tmp_path, declared, method, nodes):
    (history,) = read_oem(write(tmp_path, OEM.replace("TIME_SYSTEM = UTC", f"TIME_SYSTEM = UTC\n{declared}", 1)))
    assert (history.method, history.nodes) == (method, nodes)


def test_cic_files_count_modified_julian_days_and_seconds(tmp_path):
    text = """CIC_OEM_VERS = 2.0
META_START
OBJECT_NAME = SAT
CENTER_NAME = EARTH
REF_FRAME = ITRF
TIME_SYSTEM = UTC
META_STOP
60615 0.0 7000.0 0.0 0.0
60615 10.5 7000.0 10.5 0.0
"""
    (history,) = read_oem(write(tmp_path, text))
    assert history.epoch == EPOCH
    assert history.frame.kind == "ecef"
    assert history.segments[0].t.tolist() == [0.0, 10.5]
    assert history.segments[0].rates is None


def test_attitudes_from_a_to_b_turn_body_vectors_into_reference_vectors(tmp_path):
    assert quaternion.angle_between(q_of(write(tmp_path, AEM)), SIXTY) < 1e-9


@pytest.mark.parametrize(
    "changes",
    [
        {"A2B": "B2A", "0.5 0.866": "-0.5 0.866"},
        {"REF_FRAME_A = ICRF": "REF_FRAME_A = SC_BODY_1", "REF_FRAME_B = SC_BODY_1": "REF_FRAME_B = ICRF",
         "A2B": "B2A"},
        {"LAST": "FIRST", "0.0 0.0 0.5 0.8660254037844386": "0.8660254037844386 0.0 0.0 0.5"},
        {"QUATERNION_TYPE = LAST\n": "", "AEM_VERS = 1.0": "AEM_VERS = 2.0"},
        {"QUATERNION_TYPE = LAST\n": "", "ATTITUDE_DIR = A2B\n": "", "AEM_VERS = 1.0": "AEM_VERS = 2.0"},
        {"= QUATERNION\nQUATERNION_TYPE = LAST": "= EULER_ANGLE\nEULER_ROT_SEQ = ZYX", "ATTITUDE_DIR = A2B\n": "",
         "AEM_VERS = 1.0": "AEM_VERS = 2.0", "0.0 0.0 0.5 0.8660254037844386": "60.0 0.0 0.0"},
        {"= QUATERNION\n": "= QUATERNION/RATE\n", "0.8660254037844386\n": "0.8660254037844386 0 0 0.1\n"},
        {"= QUATERNION\nQUATERNION_TYPE = LAST": "= EULER_ANGLE\nEULER_ROT_SEQ = 321",
         "0.0 0.0 0.5 0.8660254037844386": "60.0 0.0 0.0"},
    ],
)  # fmt: skip
def test_every_spelling_of_one_attitude_reads_the_same(tmp_path, changes):
    text = AEM
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    assert quaternion.angle_between(q_of(write(tmp_path, text)), SIXTY) < 1e-9


def test_the_place_of_the_scalar_is_demanded_where_version_one_leaves_it_open(tmp_path):
    path = write(tmp_path, AEM.replace("QUATERNION_TYPE = LAST\n", ""))
    with pytest.raises(InputError, match=r"line 4: QUATERNION_TYPE is missing.* --reader.quaternion-order"):
        read_aem(path)
    assert quaternion.angle_between(q_of(path, order="xyzw"), SIXTY) < 1e-9


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("CCSDS_OEM_VERS = 2.0", "", "CCSDS_OEM_VERS is missing"),
        ("TIME_SYSTEM = UTC", "TIME_SYSTEM = MET", "line 4: TIME_SYSTEM is MET, read are UTC, TAI, GPS, TT and TDB"),
        ("TIME_SYSTEM = UTC", "TIME_SYSTEM = TAI", "line 4: epochs in TAI and UTC: export all META sections in UTC"),
        ("CENTER_NAME = EARTH", "CENTER_NAME = MARS", "line 4: CENTER_NAME is MARS"),
        ("REF_FRAME = ICRF", "REF_FRAME = B1950", "line 4: REF_FRAME B1950, ICRF is not supported"),
        ("META_STOP\nCOMMENT", "COMMENT", "line 22: META_START before META_STOP|COVARIANCE_START before META_STOP"),
        ("7000.0 10.0 0.0 0.0 1.0 0.0", "7000.0 10.0", "line 15: expected 6 numbers after the epoch as in the rows"),
        ("2024-306T00:00:10.000", "2024-400T00:00:10", "line 15: '2024-400T00:00:10' is no epoch"),
        ("2024-306T00:00:10.000", "2023-306T00:00:10", "line 15: time goes backwards"),
        ("2024-306T00:00:10.000", "2024-11-01T00:00:00", "line 15: two rows share one epoch"),
        ("00:00:40\n", "00:10:40\n", "data end 600 s before STOP_TIME: the file is cut off"),
    ],
)
def test_a_damaged_oem_is_one_sentence_that_names_the_place(tmp_path, old, new, message):
    assert old in OEM
    path = write(tmp_path, OEM.replace(old, new, 1))
    with pytest.raises(InputError, match=message) as error:
        read_oem(path)
    assert str(path) in str(error.value)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("DATA_STOP\n", "", "DATA_STOP is missing: the file is cut off"),
        ("0.5 0.8660254037844386", "0.5 0.9", r"line 14: the quaternion .* has norm 1\.029"),
        ("0.5 0.8660254037844386", "0.5", "line 15: expected 3 numbers after the epoch"),
        ("= QUATERNION\n", "= QUATERNION/RATE\n", "line 14: QUATERNION/RATE needs 7 numbers"),
        ("= QUATERNION\n", "= SPIN\n", "line 4: ATTITUDE_TYPE SPIN is not supported"),
        ("ATTITUDE_DIR = A2B\n", "", "line 4: ATTITUDE_DIR is missing"),
    ],
)
def test_a_damaged_aem_is_one_sentence(tmp_path, old, new, message):
    with pytest.raises(InputError, match=message):
        read_aem(write(tmp_path, AEM.replace(old, new, 1)))
