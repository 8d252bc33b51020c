"""Whatever happens to a file, reading it gives a trajectory or one sentence, never a traceback."""

import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from proxnav.errors import InputError
from proxnav.trajectories import HoldConfig, ReaderConfig, hold, read_trajectory
from proxnav.trajectories.write import aem, oem, stk_attitude, stk_ephemeris

REPORT = """Satellite-SROC:  J2000 Position Velocity

       Time (UTCG)             x (km)        y (km)      z (km)
------------------------    -----------    ----------    --------
 1 Nov 2024 00:00:00.000    7000.000000      0.000000    0.000000
 1 Nov 2024 00:01:00.000    6985.000000    449.700000    0.000000
"""
TABLE = """Time [s],ECI X_1 [km],ECI Y_1 [km],ECI Z_1 [km],Beta0_1,Beta1,Beta2_1,Beta3_1
0,7000,0,0,1,0,0,0
10,7000,75,0,1,0,0,0
20,7000,150,0,1,0,0,0
"""
JUNK = ["", " ", "x", "nan", "1e999", "-", "END Ephemeris\n", "\n", "0", "META_STOP", ",", "=", "9" * 30]
FLOWN = hold(HoldConfig(duration_s=40.0, step_s=10.0))
FILES = {
    "craft.e": stk_ephemeris(FLOWN, "target"),
    "craft.oem": oem(FLOWN, "target"),
    "report.txt": REPORT,
    "table.csv": TABLE,
    "craft.a": stk_attitude(FLOWN, "target"),
    "craft.aem": aem(FLOWN, "target"),
}


def read_or_refuse(folder, name, text):
    path, orbit = folder / name, folder / "orbit.e"
    path.write_text(text)
    orbit.write_text(FILES["craft.e"])
    paths = [orbit, path] if name in ("craft.a", "craft.aem") else [path]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        try:
            trajectory = read_trajectory(paths, ReaderConfig(frame="J2000"))
        except InputError:
            return None
    assert np.isfinite(trajectory.r_eci_target_m).all()
    return trajectory


@pytest.mark.parametrize("name", FILES)
def test_the_undamaged_file_reads(tmp_path, name):
    assert read_or_refuse(tmp_path, name, FILES[name]) is not None


@pytest.mark.parametrize("name", FILES)
def test_a_file_cut_off_anywhere_reads_or_is_refused(tmp_path, name):
    text = FILES[name]
    for end in range(0, len(text), max(1, len(text) // 60)):
        read_or_refuse(tmp_path, name, text[:end])


@pytest.mark.parametrize("name", FILES)
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_a_file_with_something_pasted_over_it_reads_or_is_refused(tmp_path, name, data):
    text = FILES[name]
    start = data.draw(st.integers(0, len(text) - 1))
    length = data.draw(st.integers(0, 30))
    junk = data.draw(st.sampled_from(JUNK))
    read_or_refuse(tmp_path, name, text[:start] + junk + text[start + length :])
