"""Files to one Trajectory: roles, declared laws, resampling, round trips through our own writers."""

import numpy as np
import pytest

from proxnav.errors import InputError, InputNote
from proxnav.geometry import quaternion
from proxnav.geometry.celestial import R_eci_lvlh
from proxnav.trajectories import (
    FlightConfig,
    PointingConfig,
    ReaderConfig,
    SafetyEllipseConfig,
    read_trajectory,
    walking_safety_ellipse,
)
from proxnav.trajectories.write import aem, oem, stk_attitude, stk_ephemeris

CAMERA_IN_FILE = ReaderConfig(q_chaser_cam=(1.0, 0.0, 0.0, 0.0))


@pytest.fixture(scope="module")
def flown():
    flight = FlightConfig(pointing=PointingConfig(roll_deg=20.0, jitter_deg=0.5))
    return walking_safety_ellipse(SafetyEllipseConfig(orbits=0.2, step_s=30.0), flight)


def write_all(folder, trajectory, ephemeris, attitude, ending):
    paths = [folder / f"{craft}{end}" for end in ending for craft in ("target", "chaser")]
    writers = [(write, craft) for write in (ephemeris, attitude) for craft in ("target", "chaser")]
    for path, (write, craft) in zip(paths, writers, strict=True):
        path.write_text(write(trajectory, craft))
    return paths


@pytest.mark.parametrize(
    ("ephemeris", "attitude", "ending"), [(stk_ephemeris, stk_attitude, (".e", ".a")), (oem, aem, (".oem", ".aem"))]
)
def test_a_written_trajectory_reads_back(tmp_path, flown, ephemeris, attitude, ending):
    paths = write_all(tmp_path, flown, ephemeris, attitude, ending)
    back = read_trajectory(paths, CAMERA_IN_FILE)
    assert back.epoch_utc == flown.epoch_utc
    assert back.t == pytest.approx(flown.t, abs=1e-8)
    for name in ("r_eci_target_m", "r_eci_chaser_m", "v_eci_target_mps", "v_eci_chaser_mps", "sun_eci"):
        assert getattr(back, name) == pytest.approx(getattr(flown, name), abs=1e-6)
    for name in ("q_eci_target", "q_eci_cam"):
        assert np.max(quaternion.angle_between(getattr(back, name), getattr(flown, name))) < 1e-9
    assert back.range_m == pytest.approx(flown.range_m, abs=1e-6)


def test_resampled_states_agree_with_the_orbit_between_the_files_points(tmp_path, flown):
    paths = write_all(tmp_path, flown, stk_ephemeris, stk_attitude, (".e", ".a"))[:2]
    fine = walking_safety_ellipse(SafetyEllipseConfig(orbits=0.2, step_s=7.0))
    back = read_trajectory(paths, ReaderConfig(step_s=7.0, stop_s=1000.0))
    assert back.t[-1] <= 1000.0
    count = len(back)
    assert back.r_eci_chaser_m == pytest.approx(fine.r_eci_chaser_m[:count], abs=1e-4)
    asked = read_trajectory(paths, t=np.array([3.0, 500.5]))
    assert asked.t.tolist() == [3.0, 500.5]


def test_roles_follow_order_or_names(tmp_path, flown):
    target, chaser = write_all(tmp_path, flown, stk_ephemeris, stk_attitude, (".e", ".a"))[:2]
    swapped = read_trajectory([chaser, target])
    assert swapped.r_eci_target_m == pytest.approx(flown.r_eci_chaser_m, abs=1e-6)
    named = read_trajectory([chaser, target], ReaderConfig(target="target"))
    assert named.r_eci_target_m == pytest.approx(flown.r_eci_target_m, abs=1e-6)
    with pytest.raises(InputError, match="no object 'rider' in the files, only target, chaser"):
        read_trajectory([target, chaser], ReaderConfig(target="rider"))


def test_the_basilisk_sample_has_its_separations(shared_data):
    trajectory = read_trajectory([shared_data / "basilisk" / "scHoldTraj_rotating_EP.csv"])
    assert len(trajectory) == 1801
    assert trajectory.range_m[0] == pytest.approx(10.0, abs=1e-6)
    assert trajectory.range_m.min() == pytest.approx(9.9944, abs=5e-5)
    assert np.linalg.norm(trajectory.r_eci_target_m[0]) == pytest.approx(42464000.0, abs=1.0)
    assert trajectory.T_cam_target(900).t_m == pytest.approx([0.0, 0.0, trajectory.range_m[900]], abs=1e-6)


def test_doubtful_attitudes_warn_only_when_they_are_used(shared_data):
    path = shared_data / "basilisk" / "scHoldTraj_rotating_EP.csv"
    with pytest.warns(UserWarning, match="attitude of 1: its quaternions turn"):
        read_trajectory([path], ReaderConfig(q_chaser_cam=(1.0, 0.0, 0.0, 0.0), stop_s=100.0))


def test_a_single_orbit_is_the_targets_and_the_chaser_holds(shared_data):
    path = shared_data / "stk" / "SatelliteTests_External_Satellite1.e"
    trajectory = read_trajectory([path], ReaderConfig(chaser_ric_m=(0.0, -25.0, 0.0)))
    assert np.linalg.norm(trajectory.r_eci_target_m[0]) / 1e3 == pytest.approx(6678.137, abs=1e-6)
    assert trajectory.epoch_utc == "2009-09-09T16:00:00Z"
    assert trajectory.range_m == pytest.approx(np.full(1441, 25.0))
    R = R_eci_lvlh(trajectory.r_eci_target_m[5], trajectory.v_eci_target_mps[5])
    assert quaternion.to_matrix(trajectory.q_eci_target[5]) == pytest.approx(R, abs=1e-9)
    assert 0.3 < 1.0 - trajectory.sun_visible.mean() < 0.45


def test_relative_reports_need_no_orbit(tmp_path):
    path = tmp_path / "ric.csv"
    path.write_text("Time (EpSec),Radial (m),In-Track (m),Cross-Track (m)\n0,1,-30,2\n10,1,-29,2\n20,1,-28,2\n")
    with pytest.warns(InputNote, match=r"RIC .*: 28\.\d* to 30\.\d* m from the target, whose orbit is a circle"):
        trajectory = read_trajectory([path])
    assert trajectory.range_m[0] == pytest.approx(np.sqrt(1 + 900 + 4))
    assert len(trajectory) == 3


def test_mounted_cameras_use_the_chasers_attitude(tmp_path, flown):
    paths = write_all(tmp_path, flown, stk_ephemeris, stk_attitude, (".e", ".a"))
    mount = quaternion.exp(np.array([0.0, 0.3, 0.0]))
    back = read_trajectory(paths, ReaderConfig(q_chaser_cam=tuple(mount.tolist())))
    turn = quaternion.multiply(quaternion.conjugate(flown.q_eci_cam), back.q_eci_cam)
    assert quaternion.log(turn) == pytest.approx(np.tile([0.0, 0.3, 0.0], (len(back), 1)), abs=1e-9)


@pytest.mark.parametrize(
    ("axes", "rest"), [("LVLH", np.eye(3)), ("RTN", np.array([[0, 0, -1], [1, 0, 0], [0, -1, 0]]))]
)
def test_attitudes_in_orbital_axes_follow_the_crafts_orbit(tmp_path, flown, axes, rest):
    """`rest` is the LVLH-fixed attitude in those axes, as columns: ahead, against the normal, nadir."""
    paths = write_all(tmp_path, flown, oem, aem, (".oem", ".aem"))
    q = quaternion.from_matrix(rest.astype(float))
    text = paths[2].read_text().replace("REF_FRAME_A = ICRF", f"REF_FRAME_A = {axes}")
    head, rows = text.split("DATA_START\n")
    stamps = [row.split()[0] for row in rows.splitlines()[:-1]]
    data = "\n".join(f"{stamp} {q[1]} {q[2]} {q[3]} {q[0]}" for stamp in stamps)
    paths[2].write_text(f"{head}DATA_START\n{data}\nDATA_STOP\n")
    back = read_trajectory(paths[:3])
    assert np.max(quaternion.angle_between(back.q_eci_target, flown.q_eci_target)) < 1e-9


def test_a_wrong_unit_is_found_out_by_earths_radius(tmp_path, flown):
    path = tmp_path / "target.e"
    text = stk_ephemeris(flown, "target")
    path.write_text(text.replace("DistanceUnit Meters", "DistanceUnit Feet"))
    with pytest.raises(InputError, match=r"inside Earth: check the unit of length"):
        read_trajectory([path])


def test_states_that_are_no_orbit_are_refused(tmp_path):
    path = tmp_path / "still.csv"
    path.write_text("Time [s],x [km],y [km],z [km],vx [km/s],vy [km/s],vz [km/s]\n0,7000,0,0,0,0,0\n9,7000,0,0,0,0,0\n")
    with pytest.raises(InputError, match="does not move around Earth"):
        read_trajectory([path], ReaderConfig(frame="J2000"))
    path.write_text(path.read_text().replace("7000", "7e12"))
    with pytest.raises(InputError, match="beyond any orbit about Earth"):
        read_trajectory([path], ReaderConfig(frame="J2000"))


def test_files_without_common_time_or_orbit_are_refused(tmp_path, flown):
    paths = write_all(tmp_path, flown, stk_ephemeris, stk_attitude, (".e", ".a"))
    paths[1].write_text(paths[1].read_text().replace("2024", "2025"))
    with pytest.raises(InputError, match="share no time"):
        read_trajectory(paths[:2])
    with pytest.raises(InputError, match="attitudes but no positions"):
        read_trajectory(paths[2:3])


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("none.e", None, "no such file"),
        ("empty.csv", b" \n", "empty file"),
        ("binary.e", b"stk.v.8.0\n\x00\x01", "a binary file"),
        ("bare.e", b"BEGIN Ephemeris\nEND Ephemeris\n", "the banner stk.v.<number> is missing"),
        ("words.csv", b"hello world\n", "a header but no data rows|no header"),
    ],
)
def test_files_that_are_no_trajectories_are_one_sentence(tmp_path, name, content, message):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=message) as error:
        read_trajectory([path])
    assert str(path) in str(error.value)
