"""Clear air: colours of the sky and agreement with closed forms."""

import numpy as np

from proxnav.rendering.earth import atmosphere as atm
from proxnav.rendering.earth.ellipsoid import A_M


def sky(mu_view: float, mu_sun: float, nu: float) -> np.ndarray:
    """Radiance of the sky seen from the ground, per unit irradiance."""
    air, out, r = atm.air(), np.empty(12), A_M + 1.0
    end = atm._exit_distance(r, mu_view)
    atm.march(air.transmittance, air.multiple, r, mu_view, mu_sun, nu, end, 64, out)
    return atm.rayleigh_phase(nu) * out[:3] + atm.mie_phase(nu) * out[3:6] + out[6:9]


def test_vertical_transmittance_is_the_integral_of_the_profiles():
    tau = atm.RAYLEIGH * atm.H_RAYLEIGH + atm.MIE_EXTINCTION * atm.H_MIE + atm.OZONE * 15e3
    found = atm.sun_transmittance(atm.air().transmittance, A_M + 1.0, 1.0)
    assert np.allclose(found, np.exp(-tau), rtol=2e-3)


def test_zenith_sky_is_blue_at_noon():
    red, green, blue = sky(1.0, 0.7, 0.7)
    assert blue > 1.5 * red
    assert blue > green > red


def test_the_setting_sun_is_red():
    red, green, blue = atm.sun_transmittance(atm.air().transmittance, A_M + 1.0, 0.02)
    assert red > 2.0 * green > 4.0 * blue


def test_phase_functions_integrate_to_one():
    nu = np.linspace(-1.0, 1.0, 20_001)
    for phase in (atm.rayleigh_phase, atm.mie_phase):
        assert abs(2.0 * np.pi * np.trapezoid([phase(x) for x in nu], nu) - 1.0) < 1e-4


def test_no_sunlight_in_earths_shadow():
    r = A_M + 400e3
    below = -np.sin(np.radians(21.0))
    assert atm.sun_transmittance(atm.air().transmittance, r, below) == (0.0, 0.0, 0.0)


def test_sky_light_grows_with_the_sun_and_fades_in_twilight():
    sky_light = atm.air().sky_irradiance
    assert (np.diff(sky_light[::64], axis=0) >= 0.0).all()
    assert (sky_light[0] == 0.0).all()
    assert 0.03 < sky_light[-1].mean() < 0.25
