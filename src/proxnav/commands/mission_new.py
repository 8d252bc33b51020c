"""`proxnav mission new`: a commented mission file, from options or by asking."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from proxnav.cli.options import CalibrationOptions


@dataclass(frozen=True)
class MissionNewConfig(CalibrationOptions):
    """Writes a mission file; what is needed and not given is asked for at a terminal."""

    out: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE.toml")]
    """Mission file to write; its name is the mission's."""
    target: str | None = None
    """Name of a shipped target, or the file or folder of one: proxnav target new."""
    camera: Path | None = None
    """Calibration file of the camera: docs/cameras.md"""
    range_m: tuple[float, float] | None = None
    """Least and most distance of the camera to the target's origin."""
    roll_deg: float | None = None
    """Most roll away from the local zenith up in the picture; any roll when not given."""
    attitude: Literal["lvlh", "any"] = "any"
    """any, or lvlh: the target holds its axes along the flight and to nadir."""
    phase_deg: float = 110.0
    """Largest angle at the target between Sun and camera."""
    sensor: str = "speed-class"
    """Name of the image sensor, such as speed-class, cmv4000-class or speedplus-class: docs/sensor.md"""


def run(config: MissionNewConfig) -> None:
    """Asks, checks, writes."""
    from proxnav.cli.ask import ask, ask_range
    from proxnav.errors import InputError
    from proxnav.missions.draft import Answers, draft
    from proxnav.storage.files import check_new_file, write_atomic
    from proxnav.targets.loading import load_target

    check_new_file(config.out)
    if config.out.exists():
        raise InputError(f"{config.out} exists; give the new mission another name")
    target = config.target or ask("target (a name, or the folder of target new)", "--target")
    camera = config.camera or Path(ask("calibration file of the camera", "--camera"))
    range_m = config.range_m or ask_range("least and most distance to the target [m]", "--range-m")
    answers = Answers(
        config.out.stem, target, load_target(target).radius_m, config.camera_from(camera), config.sensor, range_m,
        config.roll_deg, config.attitude, config.phase_deg,
    )  # fmt: skip
    mission, text = draft(answers)
    write_atomic(config.out, text.encode())
    print(f"{mission.describe()}\n{config.out}; look at it with: proxnav mission show {config.out}")
