"""Under which conditions poses are tried, and what each scene of them shows."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.calibration import CalibrationSigma
from proxnav.missions import Mission
from proxnav.missions.views import accepted_views
from proxnav.records import SceneSpec
from proxnav.scenes.random_scene import RandomSceneConfig, random_scene
from proxnav.targets.loading import GENERATED, load_target
from proxnav.trials.other_shapes import modified_shapes
from proxnav.trials.scene_changes import over_exposed, stars_only, striped, sun_in_lens, without_target

Shown = Literal["target", "target twice", "modified target", "other craft", "no craft", "texture"]
Change = Callable[[SceneSpec], SceneSpec]
Told = Callable[[Camera], Camera]

CUT, UNDECLARED, TWO_CRAFT = "cut by the frame", "focal length 1 % off, not declared", "two craft"
_MODIFIED = "modified"
FOCAL_ERROR = 0.01
"""Error of the focal length that the camera's file does not know, as a share."""


@dataclass(frozen=True, slots=True)
class Condition:
    """One row of the table."""

    name: str
    shown: Shown = "target"
    ranges: RandomSceneConfig | None = None
    """How scenes are drawn; as the mission says where None."""
    change: Change = lambda scene: scene
    told: Told = lambda camera: camera
    """The camera that the estimator is given."""
    subject: str = ""
    """Which other craft (a target's name or file) or which modification."""


@dataclass(frozen=True, slots=True)
class TrialScene:
    """A frame to be drawn and estimated."""

    condition: str
    shown: Shown
    subject: str
    scene: SceneSpec
    told: Camera

    @property
    def has_truth(self) -> bool:
        """Whether a pose can be right."""
        return self.shown in ("target", "target twice", "modified target")

    @property
    def key(self) -> str:
        """Name of the trial in files."""
        return f"{self.condition}/{self.scene.index}"


def conditions(mission: Mission, other_craft: Sequence[str], modifications: Sequence[str]) -> list[Condition]:
    """The rows: the mission as it is, then worse light, view and camera, then what is not the target."""
    r = mission.scenes
    penumbra = replace(r, sun=replace(r.sun, penumbra_share=1.0, umbra_share=0.0))
    rolled = replace(r, view=replace(r.view, roll_limit_rad=np.pi))
    near = replace(r, view=replace(r.view, range_m=_near(mission), partial_share=1.0))
    return [
        Condition("nominal"),
        Condition("Sun 20-50 deg off the axis", change=_sun_ahead),
        Condition("penumbra", ranges=penumbra),
        Condition("any roll", ranges=rolled),
        Condition(CUT, ranges=near),
        Condition("row noise", change=striped),
        Condition("over-exposed 16 times", change=lambda scene: over_exposed(scene, 16.0)),
        Condition("focal length 1 % off, declared", told=_longer_declared),
        Condition(UNDECLARED, told=_longer),
        *(Condition(f"{_MODIFIED}: {name}", "modified target", subject=name) for name in modifications),
        Condition(TWO_CRAFT, "target twice"),
        *(Condition(f"other craft: {_short(name)}", "other craft", subject=name) for name in other_craft),
        Condition("sky and Earth", "no craft", change=without_target),
        Condition("stars", "no craft", change=stars_only),
        Condition("textures like photographs", "texture"),
    ]


def all_conditions(mission: Mission, other_craft: Sequence[str] = (), only: str = "") -> list[Condition]:
    """The rows whose name holds `only`; other craft are the shipped ones that are not the target when none is named."""
    target = load_target(mission.target)
    others = other_craft or [name for name in GENERATED if name != target.name]
    rows = [one for one in conditions(mission, others, list(modified_shapes(target))) if only in one.name]
    if not rows:
        raise InputError(f"--only {only}: no condition has that in its name")
    return rows


def teaches(condition: str) -> bool:
    """Whether poses under a condition of that name calibrate trust: what one picture can show, of the craft itself.

    A focal length that is off leaves every sign where it is, the second of two craft is a craft of the same kind, and a
    craft that is nearly the target makes poses nearly right.
    """
    return condition not in (UNDECLARED, TWO_CRAFT) and not condition.startswith(_MODIFIED)


def trial_scene(condition: Condition, mission: Mission, seed: int, index: int) -> TrialScene:
    """Scene `index` of a condition, a function of (seed, index) alone."""
    ranges = mission.scenes if condition.ranges is None else condition.ranges
    cut = replace(mission, view=replace(mission.view, least_keypoints=max(4, mission.view.least_keypoints)))
    accept = accepted_views(cut if condition.name == CUT else mission, mission.camera)
    scene = random_scene(index, seed, ranges, mission.target, mission.camera, accept=accept)
    told = condition.told(mission.camera)
    return TrialScene(condition.name, condition.shown, condition.subject, condition.change(scene), told)


def _near(mission: Mission) -> tuple[float, float]:
    """Half to one and a half of the least range: most of the views are cut."""
    least = mission.view.range_m[0]
    return 0.5 * least, 1.5 * least


def _sun_ahead(scene: SceneSpec) -> SceneSpec:
    """The Sun 20 to 50 deg off the axis."""
    return sun_in_lens(scene, np.radians(20.0 + 30.0 * (scene.index % 7) / 6.0))


def _longer(camera: Camera) -> Camera:
    factor = 1.0 + FOCAL_ERROR
    return replace(camera, fx=camera.fx * factor, fy=camera.fy * factor)


def _longer_declared(camera: Camera) -> Camera:
    return replace(_longer(camera), calibration_sigma=CalibrationSigma(focal=FOCAL_ERROR))


def _short(name: str) -> str:
    """A target's name, or the last folder of its file."""
    parts = [part for part in name.replace("\\", "/").split("/") if part and part != "target.json"]
    return parts[-1].removesuffix(".glb")
