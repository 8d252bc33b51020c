"""The calibration of trust as `model.json` holds it."""

from dataclasses import asdict
from typing import Any

from proxnav.pose.trust import TrustCalibration
from proxnav.pose.trust.evidence import Doubts
from proxnav.pose.trust.hazard import HazardModel
from proxnav.pose.trust.protection import ProtectionFactors
from proxnav.pose.trust.verdict import TrustModel
from proxnav.pose.trust.widening import Widening


def calibration_json(calibration: TrustCalibration) -> dict[str, Any]:
    """As JSON content."""
    return {
        "told": _model_json(calibration.told), "untold": _model_json(calibration.untold),
        "usual": calibration.usual._asdict(), "frames": calibration.frames,
    }  # fmt: skip


def calibration_from(content: dict[str, Any]) -> TrustCalibration:
    """Inverse of `calibration_json`; KeyError or TypeError for what is none."""
    told, untold = _model(content["told"]), _model(content["untold"])
    return TrustCalibration(told, untold, Doubts(**content["usual"]), int(content["frames"]))


def _model_json(model: TrustModel) -> dict[str, Any]:
    widening = model.widening
    return {
        "hazard": asdict(model.hazard),
        "widening": {
            "constant": widening.constant, "weights": widening.weights._asdict(), "usual": widening.usual._asdict(),
        },
        "protection": asdict(model.protection),
    }  # fmt: skip


def _model(content: dict[str, Any]) -> TrustModel:
    widening = content["widening"]
    return TrustModel(
        HazardModel(**content["hazard"]),
        Widening(float(widening["constant"]), Doubts(**widening["weights"]), Doubts(**widening["usual"])),
        _factors(content["protection"]),
    )


def _factors(content: dict[str, Any]) -> ProtectionFactors:
    a, b = tuple(content["edges"]), [tuple(map(float, row)) for row in content["factors"]]
    if len(b) != len(a) + 1 or any(len(row) != 3 for row in b):
        raise ValueError("trust: a class of doubt needs three factors, and there is one class more than edges")
    return ProtectionFactors(float(content["risk"]), a, tuple((x, y, z) for x, y, z in b))
