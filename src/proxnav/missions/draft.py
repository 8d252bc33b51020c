"""A new mission as a commented TOML file, from the few answers that nobody else can give."""

import tomllib
from dataclasses import dataclass

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.missions.files import parse_mission
from proxnav.missions.mission import Mission, Span

_TEMPLATE = """# {title}
name = "{name}"
target = "{target}"          # a shipped target, or the file or folder of one: proxnav target new
frames = 100                 # of a data set, when nobody says how many

[camera]
width = {camera.width}
height = {camera.height}
fx = {camera.fx!r}
fy = {camera.fy!r}
cx = {camera.cx!r}                    # pixels count from the corner: the first one's centre is (0.5, 0.5)
cy = {camera.cy!r}
{lens}# what is not known about the camera, for every covariance
calibration_sigma = {{focal = {sigma.focal!r}, principal_px = {sigma.principal_px!r}}}
sensor = "{sensor}"         # noise, bits and optics: docs/sensor.md

[view]
range_m = [{near!r}, {far!r}]       # camera to the target's origin
range_spacing = "{spacing}"    # "log" gives near and far their share
roll_deg = {roll}              # "any", or the most roll away from the local zenith up in the picture
attitude = "{attitude}"          # "any", or "lvlh": the target holds its axes along the flight and to nadir
partial = 0.1                # share of frames in which the picture's edge may cut the target
framing_radius_m = {radius!r}   # about the target's origin, inside the picture in the other frames
least_keypoints = 4          # inside every picture

[light]
phase_deg = [0.0, {phase!r}]     # angle at the target between Sun and camera: 0 is front light
penumbra = 0.0               # share of frames in Earth's half-shadow
umbra = 0.0                  # and in its shadow

[looks]
earth = "any"                # share of frames with Earth, "any" leaves it to the geometry, "none" is a black sky
clouds = [0.2, 0.8]
textures = [0.0, 0.3]        # 0 nominal surfaces, 1 fully random

[training]                   # wider than the mission, so that it lies well inside
phase_deg = [0.0, {wider_phase!r}]
textures = [0.0, 1.0]
range_m = [{wider_near!r}, {wider_far!r}]
range_spacing = "log"
"""


@dataclass(frozen=True, slots=True)
class Answers:
    """What a mission needs to be told."""

    name: str
    target: str
    target_radius_m: float
    camera: Camera
    sensor: str
    range_m: Span
    roll_deg: float | None = None
    """Most roll away from the local zenith [deg]; None is any."""
    attitude: str = "any"
    phase_deg: float = 110.0
    """Largest angle at the target between Sun and camera [deg]."""


def draft(answers: Answers) -> tuple[Mission, str]:
    """The mission, and its commented TOML; InputError where the answers make none."""
    near, far = answers.range_m
    if not 0.0 < near <= far:
        raise InputError(f"the range needs 0 < least <= most, found {near:g} and {far:g} m")
    text = _TEMPLATE.format(
        title=f"{answers.target} from {near:g} to {far:g} m.",
        name=answers.name,
        target=answers.target,
        camera=answers.camera,
        lens=_lens(answers.camera),
        sigma=answers.camera.calibration_sigma,
        sensor=answers.sensor,
        near=near,
        far=far,
        spacing="log" if far > 4.0 * near else "uniform",
        roll='"any"' if answers.roll_deg is None else repr(answers.roll_deg),
        attitude=answers.attitude,
        radius=round(answers.target_radius_m, 3),
        phase=answers.phase_deg,
        wider_phase=min(180.0, answers.phase_deg + 20.0),
        wider_near=round(0.8 * near, 4),
        wider_far=round(1.2 * far, 4),
    )
    return parse_mission(tomllib.loads(text), "the new mission"), text


def _lens(camera: Camera) -> str:
    coefficients = ", ".join(repr(float(value)) for value in camera.distortion)
    kind = "" if camera.projection == "pinhole" else f'projection = "{camera.projection}"\n'
    return kind + (f"distortion = [{coefficients}]\n" if camera.is_distorted else "")
