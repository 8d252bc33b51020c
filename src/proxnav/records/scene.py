"""What the camera looks at, as plain data: one SceneSpec holds all that a frame depends on, in the target's frame."""

from dataclasses import asdict, dataclass, field, fields, is_dataclass
from typing import Any, Literal, get_type_hints

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.geometry.camera_record import camera_record
from proxnav.geometry.celestial import SUN_HALF_ANGLE
from proxnav.geometry.pointing import phase_angle
from proxnav.records.sensor import ExposureSpec, SensorSpec

VERSION = 1

_LATER = (("earth", "cloud_image", ""), ("sensor", "dead_pixel_share", 0.0), ("sun", "half_angle_rad", SUN_HALF_ANGLE))
"""Fields that are written only where they say something: sets from before they were there are still the same sets."""

Triple = tuple[float, float, float]
Quadruple = tuple[float, float, float, float]

SUN_IRRADIANCE = (163.45, 184.86, 181.72)
"""W/m^2 at 1 au in the bands 600-700, 500-600, 400-500 nm: 530 W/m^2 split as a 5772 K black body."""


@dataclass(frozen=True)
class SunSpec:
    """The Sun as a disc of light."""

    direction_target: Triple
    """Unit vector from the target to the Sun, in target axes."""
    visible_fraction: float = 1.0
    """1 in sunlight, 0 in umbra."""
    irradiance: Triple = SUN_IRRADIANCE
    """W/m^2 in the red, green and blue band, before `visible_fraction`."""
    half_angle_rad: float = SUN_HALF_ANGLE
    """Angular radius of the disc; larger for a laboratory's lamp."""


@dataclass(frozen=True)
class EarthSpec:
    """Earth where it is, in true size."""

    r_target_earth_m: Triple
    """Earth's centre seen from the target, in target axes."""
    q_target_ecef: Quadruple
    """Earth-fixed axes to target axes, wxyz."""
    cloud_cover: float = 0.5
    """Mean fraction of the surface under cloud; 0 is a clear Earth."""
    cloud_seed: int = 0
    atmosphere: bool = True
    city_lights: bool = True
    cloud_image: str = ""
    """Equirectangular picture of cloud, white where it is opaque, in place of procedural weather and its cover."""


Textures = Literal["none", "mild", "full"]
TEXTURE_STRENGTHS: dict[Textures, tuple[float, float]] = {"none": (0.0, 0.0), "mild": (0.0, 0.3), "full": (0.0, 1.0)}
"""Limits of how far the target's surfaces depart from nominal in frames drawn one by one."""


@dataclass(frozen=True)
class TextureSpec:
    """How the target's surfaces depart from nominal."""

    strength: float = 0.0
    """0 nominal, 0.3 mild, 1 full randomisation as in the seed study."""
    seed: int = 0


@dataclass(frozen=True)
class SceneSpec:
    """One frame to be: the same spec gives the same frame on any machine."""

    index: int
    target: str
    """Name or path of the target."""
    camera: Camera
    q_cam_target: Quadruple
    t_cam_target_m: Triple
    sun: SunSpec
    earth: EarthSpec | None = None
    """None: black sky and no Earthshine."""
    q_target_eci: Quadruple = (1.0, 0.0, 0.0, 0.0)
    """Inertial axes to target axes, for stars."""
    texture: TextureSpec = field(default_factory=TextureSpec)
    sensor: SensorSpec = field(default_factory=SensorSpec)
    exposure: ExposureSpec = field(default_factory=ExposureSpec)
    epoch_utc: str = ""
    t: float = 0.0
    """Seconds since `epoch_utc`."""
    sequence: str = ""
    """Frames of one sequence share auto exposure and trajectory; empty for single frames."""

    @property
    def T_cam_target(self) -> Pose:
        """Pose of the target in the camera frame."""
        return Pose.from_wxyz("cam", "target", self.q_cam_target, self.t_cam_target_m)

    @property
    def phase_rad(self) -> float:
        """Angle Sun, target, camera: 0 with the Sun behind the camera."""
        return float(phase_angle(np.array(self.sun.direction_target), self.T_cam_target.inverse().t_m))

    @property
    def filename(self) -> str:
        """Name of the frame's image file."""
        return f"img{self.index:06d}.png"

    def to_json(self) -> dict[str, Any]:
        """As JSON content, with the format's version."""
        content: dict[str, Any] = {"version": VERSION} | asdict(self) | {"camera": camera_record(self.camera)}
        for part, name, default in _LATER:
            if content[part] is not None and content[part][name] == default:
                del content[part][name]
        return content

    @staticmethod
    def from_json(content: Any) -> "SceneSpec":
        """Inverse of `to_json`; InputError names the missing or unknown field."""
        found = content.get("version") if isinstance(content, dict) else None
        if found != VERSION:
            raise InputError(f"scene line of version {found!r}, this proxnav reads version {VERSION}: render it again")
        return _build(SceneSpec, {key: value for key, value in content.items() if key != "version"}, "scene")


def _build(kind: Any, content: Any, path: str) -> Any:
    """A dataclass from JSON content, checked by field name and converted by type hint."""
    if not isinstance(content, dict):
        raise InputError(f"{path} must be an object, found {type(content).__name__}")
    hints = get_type_hints(kind)
    unknown = set(content) - {f.name for f in fields(kind)}
    if unknown:
        raise InputError(f"{path} has unknown field(s) {', '.join(sorted(unknown))}; expected {', '.join(hints)}")
    try:
        return kind(**{name: _convert(hints[name], value, f"{path}.{name}") for name, value in content.items()})
    except TypeError as error:
        raise InputError(f"{path} is incomplete or malformed ({error})") from None


def _convert(hint: Any, value: Any, path: str) -> Any:
    options = getattr(hint, "__args__", (hint,)) if type(None) in getattr(hint, "__args__", ()) else (hint,)
    if value is None and type(None) in options:
        return None
    hint = options[0]
    if is_dataclass(hint):
        return _build(hint, value, path)
    if isinstance(value, list):
        return tuple(value)
    return value
