"""From radiance to digital numbers, as a flight camera reads them."""

from proxnav.sensor.auto_exposure import AutoExposure, ControlState, choose_exposure, control_exposure, measure_level
from proxnav.sensor.expose import Exposure, expose

__all__ = [
    "AutoExposure",
    "ControlState",
    "Exposure",
    "choose_exposure",
    "control_exposure",
    "expose",
    "measure_level",
]
