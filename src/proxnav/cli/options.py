"""Options that several commands share: such a command's dataclass is derived from the one that holds them."""

import json
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import tyro

from proxnav.cluster.jobs import POOL, check_workers
from proxnav.detection.sessions import Backend
from proxnav.geometry import Camera
from proxnav.geometry.calibration import EXACT, CalibrationSigma
from proxnav.missions import Mission, load_mission
from proxnav.storage.files import write_json
from proxnav.trajectories.readers.config import ReaderConfig


@dataclass(frozen=True, kw_only=True)
class WorkerOptions:
    """How many jobs run at a time, and where."""

    workers: int = 1
    """Processes; on a Ray cluster, 0 takes every processor."""
    on: str = POOL
    """pool (processes of this machine), ray, or ray://host:port."""

    def check(self) -> None:
        """InputError unless so many workers can be had there; the command line asks before it runs the command."""
        check_workers(self.workers, self.on)


@dataclass(frozen=True, kw_only=True)
class CalibrationOptions:
    """What is not known about the camera."""

    calibration_sigma: CalibrationSigma = EXACT
    """Goes into every covariance; that of the camera's file when not given."""

    def camera_from(self, path: Path) -> Camera:
        """The camera of a calibration file."""
        return self.calibrated(Camera.read(path))

    def calibrated(self, camera: Camera) -> Camera:
        """A camera with the errors that the options name, where they name any."""
        return camera if self.calibration_sigma.is_exact else replace(camera, calibration_sigma=self.calibration_sigma)


@dataclass(frozen=True, kw_only=True)
class CameraOptions(CalibrationOptions):
    """Another camera than that of the mission, the data set or the records."""

    camera: Path | None = None
    """Calibration file of the camera: docs/cameras.md; the input's own when not given."""

    def camera_or(self, otherwise: Callable[[], Camera]) -> Camera:
        """The camera of the file, or the input's own."""
        return self.calibrated(otherwise()) if self.camera is None else self.camera_from(self.camera)


@dataclass(frozen=True, kw_only=True)
class ModelOptions:
    """Which model estimates, and what runs its network."""

    model: str = "space-rider"
    """Name of a shipped model, or a folder with a model.json."""
    backend: Backend = "auto"
    """What runs the network."""


@dataclass(frozen=True, kw_only=True)
class MissionOptions:
    """What is looked at, by which camera, from where and in which light."""

    mission: Annotated[str, tyro.conf.arg(aliases=("--preset",))] = "observation-10-100m"
    """Name of a shipped mission, or a TOML file: docs/missions.md"""
    target: str | None = None
    """Name or file of the target; the mission's when not given."""

    def read_mission(self) -> Mission:
        """The mission, to the target that is asked for; InputError where there is no such mission."""
        mission = load_mission(self.mission)
        return mission if self.target is None else replace(mission, target=self.target)


@dataclass(frozen=True, kw_only=True)
class TrajectoryOptions:
    """A flight from files in place of the mission's."""

    trajectory: tuple[Path, ...] = ()
    """Trajectory file(s) in place of the mission's: docs/trajectories.md"""
    reader: ReaderConfig = field(default_factory=ReaderConfig)
    """What the trajectory files do not say themselves."""


@dataclass(frozen=True, kw_only=True)
class DryRunOptions:
    """For jobs of hours."""

    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""


@dataclass(frozen=True, kw_only=True)
class DrawnTrainingOptions(MissionOptions, DryRunOptions):
    """What both networks are asked: images that never repeat, of a target, into a folder."""

    out: Path
    """Folder of checkpoints, learning curve and weights."""
    workers: int = 1
    """Processes that draw."""
    repeats: int = 4
    """Times that a drawn image is learnt from, each time as another view."""


@dataclass(frozen=True, kw_only=True)
class ResultOptions:
    """How a benchmark gives its result."""

    json: bool = False
    """Print JSON instead of a table."""
    out: Path | None = None
    """Folder for the result as JSON."""

    def give(self, found: dict[str, Any], name: str, table: Callable[[dict[str, Any]], str]) -> None:
        """Prints the result, as JSON or as a table, and keeps it in the folder as `name`.json."""
        if self.out is not None:
            write_json(self.out / f"{name}.json", found, indent=1)
        print(json.dumps(found, indent=1) if self.json else table(found))
