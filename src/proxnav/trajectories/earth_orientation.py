"""Where Earth's axes are, to centimetres in low orbit: IAU 2006/2000A, UT1 and polar motion of the IERS, by ERFA.

`geometry.celestial` turns Earth for pictures, to 0.005 deg; two files in different axes would differ by hundreds of
metres with it. Orientation: Bulletin A, daily values and a year of predictions, from the package astropy-iers-data.
"""

from dataclasses import dataclass
from functools import cache

import erfa
import numpy as np
from jaxtyping import Float

from proxnav.geometry.epochs import DAY_S, Instant
from proxnav.geometry.types import Rotation3x3
from proxnav.trajectories.time_systems import tt_from_utc

Series = Float[np.ndarray, "n"]

_MJD_JD = 2400000.5
_NODE_S = 600.0
"""The celestial pole is computed this far apart and interpolated: 1e-7 arcsec."""
_ARCSEC = np.pi / 648000.0


@dataclass(frozen=True, slots=True, eq=False)
class EarthOrientation:
    """Daily values of the IERS."""

    mjd: Series
    ut1_utc_s: Series
    polar_motion: Float[np.ndarray, "n 2"]
    """x and y of the pole [rad]."""
    pole_offset: Float[np.ndarray, "n 2"]
    """dX and dY to the pole of IAU 2006/2000A [rad]; zero where they are not published yet."""


@cache
def earth_orientation() -> EarthOrientation:
    """Bulletin A as installed; columns as its ReadMe.finals2000A says."""
    from astropy_iers_data import IERS_A_FILE

    with open(IERS_A_FILE, encoding="ascii") as file:  # noqa: PTH123
        rows = [line for line in file if line[58:68].strip()]
    columns = {
        name: np.array([float(row[a:b].strip() or 0.0) for row in rows])
        for name, (a, b) in {"mjd": (7, 15), "x": (18, 27), "y": (37, 46), "ut1": (58, 68), "dx": (97, 106),
                             "dy": (116, 125)}.items()
    }  # fmt: skip
    pole = np.stack([columns["dx"], columns["dy"]], axis=-1) * 1e-3 * _ARCSEC
    motion = np.stack([columns["x"], columns["y"]], axis=-1) * _ARCSEC
    return EarthOrientation(columns["mjd"], columns["ut1"], motion, pole)


def is_oriented(epoch: Instant, t: Series) -> bool:
    """Whether UT1 and the pole are known at all of these instants."""
    known, days = earth_orientation().mjd, _days(epoch, t)
    return bool(known[0] <= days.min() and days.max() <= known[-1])


def oriented_until() -> Instant:
    """The last instant of the predictions."""
    return Instant(int(earth_orientation().mjd[-1]), 0.0)


def R_tirs_itrs(epoch: Instant, t: Series) -> Rotation3x3:
    """Polar motion: Earth-fixed axes to those of the instant's pole, (n, 3, 3)."""
    motion = _daily(earth_orientation().polar_motion, epoch, t)
    tt = _julian(tt_from_utc(epoch), t)
    return np.swapaxes(erfa.pom00(motion[:, 0], motion[:, 1], erfa.sp00(*tt)), -1, -2)


def R_icrs_tirs(epoch: Instant, t: Series) -> Rotation3x3:
    """Axes of the instant's pole, turning with Earth, to inertial ones, (n, 3, 3)."""
    era = erfa.era00(*_ut1(epoch, t))
    spin = erfa.rz(era, np.broadcast_to(np.eye(3), (len(t), 3, 3)))
    return np.swapaxes(spin @ _celestial_to_intermediate(epoch, t), -1, -2)


def R_tirs_teme(epoch: Instant, t: Series) -> Rotation3x3:
    """True equator, mean equinox (of SGP4) to the axes that turn with Earth: by mean sidereal time (IAU 1982)."""
    return erfa.rz(erfa.gmst82(*_ut1(epoch, t)), np.broadcast_to(np.eye(3), (len(t), 3, 3)))


def R_icrs_j2000() -> Rotation3x3:
    """Mean equator and equinox of J2000 to ICRS: the frame bias, 0.02 arcsec or 0.8 m in low orbit."""
    bias, _, _ = erfa.bp06(2451545.0, 0.0)
    return bias.T


def _celestial_to_intermediate(epoch: Instant, t: Series) -> Rotation3x3:
    tt = tt_from_utc(epoch)
    count = max(int(np.ceil((t.max() - t.min()) / _NODE_S)) + 1, 2)
    nodes = np.linspace(t.min(), max(t.max(), t.min() + 1.0), min(count, 100_000))
    x, y, s = (np.interp(t, nodes, values) for values in erfa.xys06a(*_julian(tt, nodes)))
    offset = _daily(earth_orientation().pole_offset, epoch, t)
    return erfa.c2ixys(x + offset[:, 0], y + offset[:, 1], s)


def _ut1(epoch: Instant, t: Series) -> tuple[float, Series]:
    day, part = _julian(epoch, t)
    return day, part + np.interp(_days(epoch, t), earth_orientation().mjd, earth_orientation().ut1_utc_s) / DAY_S


def _julian(epoch: Instant, t: Series) -> tuple[float, Series]:
    return _MJD_JD + epoch.mjd, (epoch.second + t) / DAY_S


def _days(epoch: Instant, t: Series) -> Series:
    return epoch.mjd + (epoch.second + t) / DAY_S


def _daily(values: Float[np.ndarray, "n_days 2"], epoch: Instant, t: Series) -> Float[np.ndarray, "n 2"]:
    known, days = earth_orientation().mjd, _days(epoch, t)
    return np.stack([np.interp(days, known, column) for column in values.T], axis=-1)
