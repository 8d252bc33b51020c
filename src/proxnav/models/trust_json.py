"""The calibration of trust as `model.json` holds it."""

from dataclasses import asdict
from typing import Any

from proxnav.pose.trust import TrustCalibration
from proxnav.pose.trust.evidence import Doubts
from proxnav.pose.trust.hazard import HazardModel
from proxnav.pose.trust.protection import ProtectionFactors


def calibration_json(calibration: TrustCalibration) -> dict[str, Any]:
    """As JSON content."""
    return asdict(calibration) | {"usual": calibration.usual._asdict()}


def calibration_from(content: dict[str, Any]) -> TrustCalibration:
    """Inverse of `calibration_json`; KeyError or TypeError for what is none."""
    return TrustCalibration(
        told=HazardModel(**content["told"]),
        untold=HazardModel(**content["untold"]),
        usual=Doubts(**content["usual"]),
        protection_told=_factors(content["protection_told"]),
        protection_untold=_factors(content["protection_untold"]),
        frames=int(content["frames"]),
    )


def _factors(content: dict[str, Any]) -> ProtectionFactors:
    a, b = tuple(content["edges"]), [tuple(map(float, row)) for row in content["factors"]]
    if len(b) != len(a) + 1 or any(len(row) != 3 for row in b):
        raise ValueError("trust: a class of doubt needs three factors, and there is one class more than edges")
    widenings = tuple(float(value) for value in content["widenings"])
    if len(widenings) != len(b):
        raise ValueError("trust: a class of doubt needs a factor on the covariance")
    return ProtectionFactors(float(content["risk"]), a, tuple((x, y, z) for x, y, z in b), widenings)
