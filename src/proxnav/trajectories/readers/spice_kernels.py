"""SPICE kernels (SPK orbits, CK attitudes) by NAIF's own library; times by ERFA, so no leap seconds kernel is needed.

What they hold are functions of time, sampled here so densely that interpolation between the samples is exact to a
millimetre (orbits) and a step of a second (attitudes).
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.epochs import Instant
from proxnav.trajectories.readers.config import ReaderConfig
from proxnav.trajectories.readers.history import AttitudeHistory, History, OrbitHistory, Segment, Series
from proxnav.trajectories.readers.reference_frames import ReferenceFrame
from proxnav.trajectories.time_systems import to_utc

_BINARY = (b"DAF/SPK", b"DAF/CK", b"NAIF/DAF")
_TEXT = b"KPL/"
_ORBIT_STEP_S, _ATTITUDE_STEP_S = 30.0, 1.0
_MOST_SAMPLES = 300_000
_J2000 = Instant(51544, 43_200.0)  # of TDB, which SPICE counts in
_EARTH = "399"
_ECI = ReferenceFrame("eci")  # SPICE calls the ICRF's axes J2000


def is_kernel(path: str | Path, head: bytes) -> bool:
    """Whether a file is a SPICE kernel: SPK, CK, or text such as a clock's (SCLK) or frames'."""
    return head.startswith((*_BINARY, _TEXT))


def read_kernels(paths: Sequence[str | Path], config: ReaderConfig) -> list[History]:
    """Orbits of the bodies in SPK files about Earth, and attitudes of the frames in CK files."""
    found: list[History] = []
    with _loaded(paths) as spice:
        for path in paths:
            kind = spice.getfat(str(path))[1]
            if kind == "SPK":
                found += [_orbit(spice, path, int(body), config) for body in spice.spkobj(str(path))]
            elif kind == "CK":
                found += [_attitude(spice, path, int(body), config) for body in spice.ckobj(str(path))]
    if not found:
        raise InputError(f"{', '.join(map(str, paths))}: text kernels alone; give an SPK (.bsp) or CK (.bc) as well")
    return found


@contextmanager
def _loaded(paths: Sequence[str | Path]) -> Iterator[ModuleType]:
    """spiceypy with the kernels, which are unloaded at the end; what it refuses is an InputError."""
    names = ", ".join(map(str, paths))
    try:
        import spiceypy as spice
        from spiceypy.utils.exceptions import SpiceyError
    except ImportError:
        raise InputError(f"{names}: SPICE kernels, which spiceypy reads: pip install 'proxnav[spice]'") from None
    try:
        for path in paths:
            spice.furnsh(str(path))
        yield spice
    except SpiceyError as error:
        reason = " ".join(str(error).split())[:300]
        raise InputError(f"{names}: SPICE says {reason}; give the kernels that are missing too") from None
    finally:
        for path in paths:
            spice.unload(str(path))


def _orbit(spice: ModuleType, path: str | Path, body: int, config: ReaderConfig) -> OrbitHistory:
    segments = []
    cover = spice.spkcov(str(path), body)
    pieces = [spice.wnfetd(cover, k) for k in range(spice.wncard(cover))]
    start = pieces[0][0]
    for first, last in pieces:
        et = _instants(path, first, last, min(config.step_s or _ORBIT_STEP_S, _ORBIT_STEP_S))
        states = np.array([spice.spkgeo(body, float(x), "J2000", int(_EARTH))[0] for x in et]) * 1e3
        segments.append(Segment(et - start, states[:, :3], states[:, 3:]))
    return OrbitHistory(_name(spice, body), str(path), _utc(start), _ECI, tuple(segments), "hermite", 4)


def _attitude(spice: ModuleType, path: str | Path, body: int, config: ReaderConfig) -> AttitudeHistory:
    segments = []
    cover = spice.ckcov(str(path), body, False, "INTERVAL", 0.0, "TDB")
    pieces = [spice.wnfetd(cover, k) for k in range(spice.wncard(cover))]
    start = pieces[0][0]
    clock = spice.ckmeta(body, "SCLK")
    for first, last in pieces:
        et = _instants(path, first, last, min(config.step_s or _ATTITUDE_STEP_S, _ATTITUDE_STEP_S))
        turns = [spice.ckgp(body, spice.sce2c(clock, float(x)), 0.5, "J2000")[0] for x in et]  # reference to body
        q = quaternion.conjugate(quaternion.from_matrix(np.array(turns)))
        segments.append(Segment(et - start, q))
    # The attitude of body -n000 or of one of its frames -nkkk goes by the name of the craft -n.
    craft = body if body > -1000 else -(-body // 1000)
    return AttitudeHistory(_name(spice, craft), str(path), _utc(start), _ECI, tuple(segments))


def _instants(path: str | Path, first: float, last: float, step: float) -> Series:
    count = int(np.ceil((last - first) / step)) + 1
    if count > _MOST_SAMPLES:
        raise InputError(
            f"{path}: covers {last - first:.3g} s, {count} steps of {step:g} s, of which {_MOST_SAMPLES} are "
            "read at most; cut it shorter, or say a larger --reader.step-s where that is small"
        )
    return np.linspace(first, last, max(count, 2))


def _utc(et: float) -> Instant:
    return to_utc(_J2000.plus(et), "TDB")


def _name(spice: ModuleType, body: int) -> str:
    """The name that the kernels give a body, or its number."""
    with spice.no_found_check():
        name, is_known = spice.bodc2n(body)
    return name if is_known else str(body)
