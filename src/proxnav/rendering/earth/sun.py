"""The Sun's disc: true size, darker towards the limb."""

import math

from proxnav.geometry.celestial import SUN_HALF_ANGLE
from proxnav.geometry.compiled.kernel import fast_kernel

# Quadratic limb darkening in the three bands (about 650, 550, 450 nm), after C. W. Allen, Astrophysical Quantities.
_U = ((0.47, 0.20), (0.55, 0.23), (0.66, 0.20))


@fast_kernel
def disc(nu, band):
    """Radiance per unit irradiance [1/sr] at angle arccos(nu) from the centre; integrates to one over the disc."""
    sin2 = math.sin(SUN_HALF_ANGLE) ** 2
    s2 = 1.0 - nu * nu
    if nu <= 0.0 or s2 >= sin2:
        return 0.0
    mu = math.sqrt(1.0 - s2 / sin2)
    u1, u2 = _U[band]
    profile = 1.0 - u1 * (1.0 - mu) - u2 * (1.0 - mu) ** 2
    return profile / (math.pi * sin2 * (1.0 - u1 / 3.0 - u2 / 6.0))
