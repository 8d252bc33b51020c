"""The brightest stars as points of light in the camera's three bands."""

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.records import SceneSpec

# Name: right ascension [h], declination [deg] (J2000), visual magnitude, colour index B-V. Rounded from the Bright Star
# Catalogue, 5th edition (D. Hoffleit, W. H. Warren, 1991), which is in the public domain.
BRIGHT = {
    "Sirius": (6.752, -16.716, -1.46, 0.00),
    "Canopus": (6.399, -52.696, -0.72, 0.15),
    "Rigil Kentaurus": (14.660, -60.834, -0.27, 0.71),
    "Arcturus": (14.261, 19.182, -0.04, 1.23),
    "Vega": (18.616, 38.784, 0.03, 0.00),
    "Capella": (5.278, 45.998, 0.08, 0.80),
    "Rigel": (5.242, -8.202, 0.12, -0.03),
    "Procyon": (7.655, 5.225, 0.38, 0.42),
    "Achernar": (1.629, -57.237, 0.46, -0.16),
    "Betelgeuse": (5.919, 7.407, 0.50, 1.85),
    "Hadar": (14.064, -60.373, 0.61, -0.23),
    "Altair": (19.846, 8.868, 0.77, 0.22),
    "Acrux": (12.443, -63.099, 0.77, -0.24),
    "Aldebaran": (4.599, 16.509, 0.85, 1.54),
    "Antares": (16.490, -26.432, 0.96, 1.83),
    "Spica": (13.420, -11.161, 0.98, -0.23),
    "Pollux": (7.755, 28.026, 1.14, 1.00),
    "Fomalhaut": (22.961, -29.622, 1.16, 0.09),
    "Deneb": (20.690, 45.280, 1.25, 0.09),
    "Mimosa": (12.795, -59.689, 1.25, -0.23),
    "Regulus": (10.139, 11.967, 1.35, -0.11),
    "Adhara": (6.977, -28.972, 1.50, -0.21),
    "Castor": (7.577, 31.888, 1.58, 0.03),
    "Gacrux": (12.519, -57.113, 1.63, 1.59),
    "Shaula": (17.560, -37.104, 1.63, -0.22),
    "Bellatrix": (5.419, 6.350, 1.64, -0.22),
    "Elnath": (5.438, 28.608, 1.65, -0.13),
    "Miaplacidus": (9.220, -69.717, 1.68, 0.00),
    "Alnilam": (5.604, -1.202, 1.70, -0.19),
    "Alnair": (22.137, -46.961, 1.74, -0.13),
    "Alioth": (12.900, 55.960, 1.77, -0.02),
    "Alnitak": (5.679, -1.943, 1.77, -0.21),
    "Dubhe": (11.062, 61.751, 1.79, 1.07),
    "Mirfak": (3.405, 49.861, 1.79, 0.48),
    "Wezen": (7.140, -26.393, 1.84, 0.68),
    "Kaus Australis": (18.403, -34.385, 1.85, -0.03),
    "Alkaid": (13.792, 49.313, 1.86, -0.19),
    "Sargas": (17.622, -42.998, 1.87, 0.40),
    "Avior": (8.375, -59.510, 1.86, 1.28),
    "Menkalinan": (5.992, 44.947, 1.90, 0.03),
    "Atria": (16.811, -69.028, 1.92, 1.44),
    "Alhena": (6.629, 16.399, 1.93, 0.00),
    "Peacock": (20.427, -56.735, 1.94, -0.20),
    "Mirzam": (6.378, -17.956, 1.98, -0.23),
    "Alphard": (9.460, -8.659, 1.98, 1.44),
    "Polaris": (2.530, 89.264, 2.02, 0.60),
    "Hamal": (2.120, 23.462, 2.00, 1.15),
    "Diphda": (0.727, -17.987, 2.04, 1.02),
    "Nunki": (18.921, -26.297, 2.02, -0.22),
    "Alpheratz": (0.140, 29.090, 2.06, -0.11),
    "Saiph": (5.796, -9.670, 2.09, -0.17),
    "Mintaka": (5.533, -0.299, 2.23, -0.22),
    "Denebola": (11.818, 14.572, 2.14, 0.09),
    "Mizar": (13.399, 54.925, 2.27, 0.02),
    "Merak": (11.031, 56.382, 2.37, -0.02),
    "Phecda": (11.897, 53.695, 2.44, 0.00),
    "Caph": (0.153, 59.150, 2.27, 0.34),
    "Schedar": (0.675, 56.537, 2.23, 1.17),
}

ZERO_MAGNITUDE = (2.1e-9, 3.6e-9, 5.8e-9)
"""W/m^2 of a star of magnitude 0 and B-V = 0 in 600-700, 500-600, 400-500 nm: Vega's flux densities times 100 nm."""
_COLOUR = (0.55, 0.0, -1.0)
"""Magnitudes by which each band brightens per unit of B-V, at fixed V."""


def stars(scene: SceneSpec) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
    """Unit directions in target axes and irradiances [W/m^2] in three bands of the bright stars, Earth ignored.

    >>> from proxnav.rendering.earth.stars import BRIGHT
    >>> min(BRIGHT, key=lambda name: BRIGHT[name][2])
    'Sirius'
    """
    hours, declination, magnitude, colour = np.array(list(BRIGHT.values())).T
    ra, dec = np.radians(15.0 * hours), np.radians(declination)
    eci = np.stack([np.cos(dec) * np.cos(ra), np.cos(dec) * np.sin(ra), np.sin(dec)], axis=-1)
    brighter = np.array(_COLOUR) * colour[:, None]
    irradiance = np.array(ZERO_MAGNITUDE) * 10.0 ** (-0.4 * (magnitude[:, None] - brighter))
    return quaternion.rotate(np.array(scene.q_target_eci), eci), irradiance
