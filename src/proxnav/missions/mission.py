"""A mission: which craft is looked at, by which camera, from where, in which light and along which flight.

Degrees stand here because people write and read missions; what is derived from them is in SI and radians.
"""

import math
from dataclasses import asdict, dataclass, field, replace
from typing import Literal

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.records import SensorSpec
from proxnav.scenes.random_scene import RandomSceneConfig
from proxnav.scenes.random_sun import SunConfig
from proxnav.scenes.random_view import ViewpointConfig
from proxnav.trajectories.readers.config import ReaderConfig

Span = tuple[float, float]
"""(least, most) of a uniform distribution."""


@dataclass(frozen=True)
class ViewRanges:
    """From where the camera looks, and how the target is turned."""

    range_m: Span = (10.0, 100.0)
    """Distance from the camera to the target's origin [m]."""
    range_spacing: Literal["uniform", "log"] = "uniform"
    """Distribution of that distance: uniform, or uniform in its logarithm."""
    least_keypoints: int = 0
    """Keypoints that lie inside the picture in every frame; where any are asked for, the camera also stays outside the
    target's convex hull."""
    roll_deg: float | Literal["any"] = "any"
    """Most roll of the camera about its axis, away from the local zenith up in the picture [deg]."""
    attitude: Literal["lvlh", "any"] = "lvlh"
    """lvlh: the target holds its axes along the flight and to nadir; any: uniform over all attitudes."""
    partial: float = 0.1
    """Share of frames in which the edge of the picture may cut the target."""
    framing_radius_m: float = 5.0
    """Radius about the target's origin that stays inside the picture in the other frames [m]."""
    port: str = ""
    """Named frame of the target, its docking port for one, that the camera comes to; empty for views from any side."""
    cone_deg: float = 180.0
    """Most angle between the port's +x axis, which points out of the craft, and the camera, at the port [deg]."""


@dataclass(frozen=True)
class Lighting:
    """Where the Sun stands."""

    phase_deg: Span = (0.0, 180.0)
    """Angle at the target between Sun and camera in sunlit frames [deg]: 0 is front light."""
    penumbra: float = 0.0
    """Share of frames in Earth's half-shadow."""
    umbra: float = 0.0
    """Share of frames in Earth's shadow."""
    lamps: float = 0.0
    """Share of the sunlit frames that a laboratory's lamp lights in place of the Sun, from where it would stand."""
    lamp_half_angle_deg: Span = (1.0, 30.0)
    """Angular radius of those lamps seen from the target [deg], uniform in its logarithm."""


@dataclass(frozen=True)
class Looks:
    """What varies from frame to frame beside geometry and light."""

    earth: float | Literal["any", "none"] = "any"
    """Share of frames with Earth in the picture; any leaves it to the geometry, none is a black sky without it."""
    clouds: Span = (0.2, 0.8)
    """Cloud cover of Earth."""
    textures: Span = (0.0, 0.3)
    """How far the target's surfaces depart from nominal: 0 not at all, 1 fully random."""


@dataclass(frozen=True)
class Flight:
    """The flight, where frames are those of a trajectory instead of independent draws."""

    trajectory: str = ""
    """Name of a generated trajectory; empty for independent frames or for `files`."""
    files: tuple[str, ...] = ()
    """Trajectory files in its place, target first; in a TOML they are looked for from its folder on."""
    reader: ReaderConfig = field(default_factory=ReaderConfig)
    """What the files do not say themselves: axes, units, the target's orbit."""

    def __post_init__(self) -> None:
        if self.trajectory and self.files:
            raise InputError(
                f"a flight is either generated or read, found trajectory '{self.trajectory}' and files "
                f"{', '.join(self.files)}; leave one out"
            )
        if not self.files and self.reader != ReaderConfig():
            raise InputError("[flight.reader] says how files are read, and there are none; name them in [flight] files")

    @property
    def is_flown(self) -> bool:
        """Whether there is a trajectory, generated or read."""
        return bool(self.trajectory or self.files)


@dataclass(frozen=True)
class TrainingRanges:
    """What training draws from instead of the mission's own ranges: wider, so that the mission lies well inside."""

    phase_deg: Span | None = None
    """As in [light]; the mission's own when absent, and so are all others here."""
    textures: Span | None = None
    """As in [looks]."""
    range_m: Span | None = None
    """As in [view], and so are the following."""
    range_spacing: Literal["uniform", "log"] | None = None
    roll_deg: float | Literal["any"] | None = None
    attitude: Literal["lvlh", "any"] | None = None
    partial: float | None = None
    least_keypoints: int | None = None


@dataclass(frozen=True)
class Mission:
    """Everything that a chain must agree on."""

    name: str
    camera: Camera
    sensor: SensorSpec
    target: str = "space-rider"
    """Name of a shipped target, or its file or folder."""
    frames: int = 100
    """Frames of a data set when nobody says how many."""
    view: ViewRanges = field(default_factory=ViewRanges)
    light: Lighting = field(default_factory=Lighting)
    looks: Looks = field(default_factory=Looks)
    flight: Flight = field(default_factory=Flight)
    training: TrainingRanges = field(default_factory=TrainingRanges)

    def __post_init__(self) -> None:
        if self.frames < 1:
            raise InputError(f"mission {self.name}: frames must be at least 1, found {self.frames}")
        roll = self.view.roll_deg
        if roll != "any" and not 0.0 <= roll <= 180.0:
            raise InputError(f'mission {self.name}: view.roll_deg needs 0 to 180 deg or "any", found {roll:g}')
        for name, (low, high) in (("light.phase_deg", self.light.phase_deg), ("looks.textures", self.looks.textures)):
            if not 0.0 <= low <= high:
                raise InputError(f"mission {self.name}: {name} needs 0 <= least <= most, found {low:g} and {high:g}")

    def describe(self) -> str:
        """Craft, camera and views in a line."""
        camera, view = self.camera, self.view
        across = 2.0 * math.degrees(math.atan(0.5 * camera.width / camera.fx))
        roll = "any roll" if view.roll_deg == "any" else f"roll within {view.roll_deg:g} deg"
        return (
            f"{self.name}: {self.target} from {view.range_m[0]:g} to {view.range_m[1]:g} m, {roll}, attitude "
            f"{view.attitude}, camera of {camera.width} x {camera.height} px, {across:.3g} deg across"
        )

    @property
    def scenes(self) -> RandomSceneConfig:
        """The distribution of the mission's frames, where they are drawn one by one."""
        view, light, looks = self.view, self.light, self.looks
        low, high = _radians(light.phase_deg)
        return RandomSceneConfig(
            view=ViewpointConfig(
                range_m=view.range_m,
                range_spacing=view.range_spacing,
                roll_limit_rad=math.pi if view.roll_deg == "any" else math.radians(view.roll_deg),
                partial_share=view.partial,
                target_radius_m=view.framing_radius_m,
            ),
            sun=SunConfig(light.umbra, light.penumbra, low, high, light.lamps, _radians(light.lamp_half_angle_deg)),
            tumbling_share=1.0 if view.attitude == "any" else 0.0,
            earth=looks.earth != "none",
            earth_share=None if isinstance(looks.earth, str) else looks.earth,
            cloud_cover=looks.clouds,
            texture_strength=looks.textures,
            sensor=self.sensor,
        )

    @property
    def training_mission(self) -> "Mission":
        """The mission that training frames are drawn from."""
        wider = {key: value for key, value in asdict(self.training).items() if value is not None}
        light = {key: wider.pop(key) for key in ("phase_deg",) if key in wider}
        looks = {key: wider.pop(key) for key in ("textures",) if key in wider}
        return replace(
            self,
            view=replace(self.view, **wider),
            light=replace(self.light, **light),
            looks=replace(self.looks, **looks),
        )


def _radians(span_deg: Span) -> Span:
    return math.radians(span_deg[0]), math.radians(span_deg[1])
