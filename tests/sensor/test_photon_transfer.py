"""The simulated EMVA 1288 experiment gives back the parameters that were set."""

from dataclasses import replace

import pytest

from proxnav.sensor.photon_transfer import run_photon_transfer
from proxnav.sensor.presets import CMV4000_CLASS, SPEED_CLASS

# PRNU, DSNU and the photon transfer are measured with 12 bit above full well, without hot pixels and line offsets
BENCH = {
    "bits": 12,
    "black_level_dn": 100.0,
    "hot_pixel_share": 0.0,
    "row_noise_dn": 0.0,
    "column_noise_dn": 0.0,
}


@pytest.mark.parametrize(
    ("sensor", "dark_current"), [(replace(SPEED_CLASS, gain_e_per_dn=8.5), 5.0), (CMV4000_CLASS, 125.0)]
)
def test_photon_transfer_returns_what_was_set(sensor, dark_current):
    sensor = replace(sensor, **BENCH)
    sensor = replace(sensor, gain_e_per_dn=sensor.full_well_e / 3800.0)
    found = run_photon_transfer(sensor, shape=(400, 400))
    assert found.gain_dn_per_e == pytest.approx(1.0 / sensor.gain_e_per_dn, rel=0.02)
    assert found.read_noise_e == pytest.approx(sensor.read_noise_e, rel=0.02)
    assert found.dark_current_e_per_s == pytest.approx(dark_current, rel=0.02)
    assert found.prnu == pytest.approx(sensor.prnu, rel=0.02)
    assert found.dsnu_e == pytest.approx(sensor.dsnu_e, rel=0.02)
    assert found.full_well_e == pytest.approx(sensor.full_well_e, rel=0.02)


def test_dark_current_is_measured_at_the_temperature_of_the_bench():
    sensor = replace(SPEED_CLASS, **BENCH)
    found = run_photon_transfer(sensor, shape=(200, 200), temperature_c=39.0, flat_levels=4, stack=2)
    assert found.dark_current_e_per_s == pytest.approx(20.0, rel=0.02)  # 14 K above the reference: two doublings
