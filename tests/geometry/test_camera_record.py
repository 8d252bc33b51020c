"""Cameras as plain values in records."""

import json
from dataclasses import replace

import pytest

from proxnav.geometry import Camera
from proxnav.geometry.calibration import CalibrationSigma
from proxnav.geometry.camera_record import camera_from_record, camera_record

PLAIN = Camera(1024, 1024, 1407.0, 1407.0, 512.0, 512.0)


@pytest.mark.parametrize(
    "camera",
    [
        PLAIN,
        replace(PLAIN, distortion=(0.1,) * 8),
        replace(PLAIN, distortion=(0.01,) * 4, projection="fisheye"),
        replace(PLAIN, calibration_sigma=CalibrationSigma(0.01, 2.0)),
    ],
)
def test_a_camera_comes_back_from_its_record(camera: Camera) -> None:
    assert camera_from_record(json.loads(json.dumps(camera_record(camera)))) == camera


def test_records_of_exact_pinholes_are_those_of_the_first_release() -> None:
    assert list(camera_record(PLAIN)) == ["width", "height", "fx", "fy", "cx", "cy", "distortion"]
