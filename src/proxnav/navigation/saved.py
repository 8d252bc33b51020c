"""A navigator on disk: everything that its next states depend on, as JSON with exact numbers."""

import importlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.calibration import CalibrationSigma
from proxnav.geometry.types import Points
from proxnav.navigation.belief import Belief
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import Ephemeris, FilterSetup, filter_setup
from proxnav.navigation.monitor.monitor import Learnt, Monitor
from proxnav.navigation.monitor.orbit_trial import OtherOrbit
from proxnav.navigation.monitor.refusals import Refusals
from proxnav.navigation.readings import Reading
from proxnav.records import Antennas
from proxnav.storage.files import read_json, write_atomic

VERSION = 1
_ROOT = "proxnav."


@dataclass(frozen=True, slots=True, eq=False)
class SavedNavigator:
    """What a navigator needs to go on; beliefs within its ring follow from the origin and the readings."""

    config: NavigationConfig
    camera: Camera
    sigma_in_poses: CalibrationSigma
    points_m: Points
    ephemeris: Ephemeris
    antennas: Antennas | None
    has_gyro: bool
    origin: Belief
    ring: tuple[Reading, ...]
    newest: float
    other: OtherOrbit | None
    learnt: Learnt
    recent: tuple[Reading, ...]
    next_t: float | None
    first_t: float
    force_t: float
    burn_t: float
    refusals: Refusals

    @classmethod
    def of(
        cls, setup: FilterSetup, origin: Belief, ring: tuple[Reading, ...], newest: float, monitor: Monitor,
        refusals: Refusals,
    ) -> "SavedNavigator":  # fmt: skip
        """From a navigator's parts."""
        return cls(
            setup.config, setup.real_camera, setup.sigma_in_poses, setup.points_m, setup.ephemeris, setup.antennas,
            setup.has_gyro, origin, ring, newest, monitor.other, monitor.learnt, tuple(monitor.recent), monitor.next_t,
            monitor.first_t, monitor.force_t, monitor.burn_t, refusals,
        )  # fmt: skip

    def monitor(self, setup: FilterSetup) -> Monitor:
        """The monitor as it was."""
        return Monitor(
            setup, self.other, self.learnt, list(self.recent), self.next_t, self.first_t, self.force_t, self.burn_t
        )


def setup_of_saved(saved: SavedNavigator) -> FilterSetup:
    """The setup that it was started with."""
    return filter_setup(
        saved.ephemeris, saved.points_m, saved.camera, saved.config, saved.has_gyro, saved.sigma_in_poses,
        saved.antennas,
    )  # fmt: skip


def write_navigator(path: Path, saved: SavedNavigator) -> None:
    """Writes the file as a whole or not at all."""
    text = json.dumps({"version": VERSION, "navigator": _plain(saved)})
    write_atomic(path, text.encode())


def read_navigator(path: Path) -> SavedNavigator:
    """Inverse of `write_navigator`; InputError where the file is none, or of another version."""
    content = read_json(path, "a navigator that was saved")
    if not isinstance(content, dict) or content.get("version") != VERSION:
        raise InputError(f"{path}: expected a navigator saved with version {VERSION}; start a new one")
    try:
        saved = _value(content["navigator"])
    except (KeyError, TypeError, ValueError, AttributeError, ImportError) as error:
        raise InputError(f"{path}: not a navigator of this version of proxnav ({error}); start a new one") from None
    if not isinstance(saved, SavedNavigator):
        raise InputError(f"{path}: holds no navigator; start a new one")
    return saved


def _plain(value: Any) -> Any:
    """As JSON has it: values of our own types under their names, arrays flat with their shape."""
    if isinstance(value, np.ndarray):
        return {"array": value.ravel().tolist(), "shape": value.shape, "dtype": value.dtype.name}
    if is_dataclass(value) and not isinstance(value, type):
        return {"type": _name(value), "fields": {f.name: _plain(getattr(value, f.name)) for f in fields(value)}}
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        named: Any = value
        return {"type": _name(value), "fields": {key: _plain(item) for key, item in named._asdict().items()}}
    if isinstance(value, tuple | frozenset):
        kind = "tuple" if isinstance(value, tuple) else "set"
        return {kind: [_plain(item) for item in (value if kind == "tuple" else sorted(value))]}
    if isinstance(value, np.generic):
        return value.item()
    return value


def _name(value: Any) -> str:
    return f"{type(value).__module__}:{type(value).__qualname__}"


def _value(plain: Any) -> Any:
    """Inverse of `_plain`."""
    if not isinstance(plain, Mapping):
        return plain
    if "array" in plain:
        return np.array(plain["array"], dtype=plain["dtype"]).reshape(plain["shape"])
    if "tuple" in plain:
        return tuple(_value(item) for item in plain["tuple"])
    if "set" in plain:
        return frozenset(_value(item) for item in plain["set"])
    module, name = plain["type"].split(":")
    if not module.startswith(_ROOT):
        raise ValueError(f"{plain['type']} is no type of proxnav")
    kind = getattr(importlib.import_module(module), name)
    if not (isinstance(kind, type) and (is_dataclass(kind) or hasattr(kind, "_fields"))):
        raise ValueError(f"{plain['type']} is no record of proxnav")
    return kind(**{key: _value(item) for key, item in plain["fields"].items()})
