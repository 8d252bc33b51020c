"""Which exposure a frame needs: at once for a single frame, by a lagging PI controller in a sequence."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.records import RenderedFrame, SceneSpec
from proxnav.sensor.detector import Counts
from proxnav.sensor.photometry import electron_rate

_PROPORTIONAL = 0.2  # gain of the controller on the change of the error, a logarithm
_INTEGRAL = 0.6  # gain on the error; 1 corrects it in one step


@dataclass(frozen=True, slots=True)
class AutoExposure:
    """What the exposure control aims at, and within which limits."""

    percentile: float = 92.0
    """Percentile of the metered pixels that is controlled."""
    level: float = 0.6
    """Share of full well at which that percentile shall lie."""
    shortest_s: float = 20e-6
    longest_s: float = 10e-3
    lag_frames: int = 1
    """Frames between a measurement and the exposure that it changes."""


@dataclass(frozen=True, slots=True)
class ControlState:
    """Memory of the controller between frames."""

    exposure_s: float
    """Exposure of the next frame."""
    error: float = 0.0
    """Last error: natural logarithm of level wanted over level expected."""
    queued: tuple[float, ...] = ()
    """Exposures decided but not yet in effect, oldest first."""


def choose_exposure(
    frame: RenderedFrame,
    scene: SceneSpec,
    control: AutoExposure | None = None,
    box_xyxy: Float[np.ndarray, "4"] | None = None,
) -> float:
    """Exposure [s] that puts the metered percentile of this frame at the level wanted, within the limits.

    The sensor's `exposure_bias` multiplies it. Metered are: the pixels of `box_xyxy` (full image, px) if given, else
    those of the target, else the whole frame.
    """
    control = control or AutoExposure()
    rate = electron_rate(_metered(frame, box_xyxy), scene.sensor)
    rate = rate.max(axis=-1) if scene.sensor.colour else rate
    peak = float(np.percentile(rate, control.percentile))
    if not peak > 0.0:
        return control.longest_s
    return _limited(scene.sensor.exposure_bias * control.level * scene.sensor.full_well_e / peak, control)


def measure_level(
    image: Counts, white_dn: int, black_level_dn: float = 0.0, control: AutoExposure | None = None
) -> float:
    """Share of the range above black at which the metered percentile of an image lies: what a controller measures."""
    control = control or AutoExposure()
    return float((np.percentile(image, control.percentile) - black_level_dn) / (white_dn - black_level_dn))


def control_exposure(state: ControlState, measured_level: float, control: AutoExposure) -> ControlState:
    """State for the next frame from the level measured in this one: PI on the logarithm of the exposure.

    In velocity form, d(log t) = ki e + kp de, which cannot wind up at a limit. The error is that expected once the
    exposures already queued are in effect (the level is proportional to the exposure), so that lag does not upset it.
    """
    latest = state.queued[-1] if state.queued else state.exposure_s
    expected_level = max(measured_level, 1e-3) * latest / state.exposure_s
    error = math.log(control.level / expected_level)
    step = _INTEGRAL * error + _PROPORTIONAL * (error - state.error)
    queued = (*state.queued, _limited(latest * math.exp(step), control))
    if len(queued) <= control.lag_frames:
        return ControlState(state.exposure_s, error, queued)
    return ControlState(queued[0], error, queued[1:])


def _limited(exposure_s: float, control: AutoExposure) -> float:
    return min(max(exposure_s, control.shortest_s), control.longest_s)


def _metered(
    frame: RenderedFrame, box_xyxy: Float[np.ndarray, "xyxy=4"] | None
) -> Float[np.ndarray, "rows columns band=3"]:
    """Radiance of the metered pixels as (1, n, 3) or (h, w, 3)."""
    if box_xyxy is not None and np.isfinite(box_xyxy).all():
        x0, y0 = np.floor(np.asarray(box_xyxy)[:2]).astype(int) - (frame.window.x, frame.window.y)
        x1, y1 = np.ceil(np.asarray(box_xyxy)[2:]).astype(int) - (frame.window.x, frame.window.y)
        box = frame.radiance[max(y0, 0) : max(y1, 0), max(x0, 0) : max(x1, 0)]
        if box.size:
            return box
    mask = frame.mask
    return frame.radiance[mask][None] if mask.any() else frame.radiance
