"""A camera as plain values in our records: what cameras gained later stands there only where it says something."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from proxnav.geometry.calibration import EXACT, CalibrationSigma
from proxnav.geometry.camera import Camera


def camera_record(camera: Camera) -> dict[str, Any]:
    """The fields of a camera; records of pinholes that are known exactly are those of the first release."""
    content = asdict(camera)
    if camera.projection == "pinhole":
        del content["projection"]
    if camera.calibration_sigma.is_exact:
        del content["calibration_sigma"]
    return content


def camera_from_record(content: Mapping[str, Any]) -> Camera:
    """Inverse of `camera_record`; TypeError or InputError where a field is missing, unknown or impossible."""
    fields = dict(content)
    sigma = fields.pop("calibration_sigma", None)
    fields["distortion"] = tuple(fields["distortion"])
    return Camera(**fields, calibration_sigma=EXACT if sigma is None else CalibrationSigma(**sigma))
