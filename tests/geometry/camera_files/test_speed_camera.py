"""SPEED+ camera.json: round trip, the field sample, and every way it can be damaged."""

import json

import pytest

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.camera_files import speed_json

CAMERA = Camera(1920, 1200, 2988.58, 2988.34, 960.0, 600.0, (-0.22, 0.51, -7e-4, -2e-4, -0.13))


def write(tmp_path, content):
    path = tmp_path / "camera.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return str(path)


def test_a_camera_written_is_the_camera_read(tmp_path):
    assert Camera.from_speed_json(write(tmp_path, speed_json(CAMERA))) == CAMERA


def test_the_sample_of_speed_plus_reads_and_holds_numbers_only(shared_data):
    path = shared_data / "speedplus" / "camera.json"
    camera = Camera.from_speed_json(path)
    assert (camera.width, camera.height, camera.cx, camera.cy) == (1920, 1200, 960.0, 600.0)
    assert camera.fx == 2988.5795163815555
    assert camera.distortion[0] == -0.22383016606510672
    theirs, ours = json.loads(path.read_text()), speed_json(camera)
    assert set(theirs) == set(ours)
    assert ours["fx"] == pytest.approx(theirs["fx"], rel=1e-6)  # metres
    assert ours["ppx"] == theirs["ppx"]


@pytest.mark.parametrize("key", ["Nu", "Nv", "cameraMatrix", "distCoeffs"])
def test_a_missing_key_is_named_with_the_file(tmp_path, key):
    content = speed_json(CAMERA)
    del content[key]
    with pytest.raises(InputError, match=rf"camera\.json: keys {key} are missing, found .* camera\.json needs"):
        Camera.from_speed_json(write(tmp_path, content))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"cameraMatrix": [[1, 0], [0, 1]]}, "cameraMatrix must be 3x3 numbers"),
        ({"cameraMatrix": [["a", 0, 0]] * 3}, "cameraMatrix must be 3x3 numbers"),
        ({"cameraMatrix": [[1000, 5, 500], [0, 1000, 500], [0, 0, 1]]}, r"cameraMatrix must be \[\[fx, 0, cx\]"),
        ({"cameraMatrix": [[1000, 0, 0], [0, 1000, 0], [500, 500, 1]]}, r"cameraMatrix must be \[\[fx, 0, cx\]"),
        ({"cameraMatrix": [[1000, 0, 500], [3, 1000, 500], [0, 0, 1]]}, r"cameraMatrix must be \[\[fx, 0, cx\]"),
        ({"cameraMatrix": [[-1000, 0, 500], [0, 1000, 500], [0, 0, 1]]}, "camera.json: .*positive"),
        ({"cameraMatrix": [[float("nan"), 0, 500], [0, 1000, 500], [0, 0, 1]]}, "camera.json: "),
        ({"distCoeffs": [1, 2, 3]}, "4, 5, 8, 12 or 14 distortion coefficients"),
        ({"distCoeffs": None}, "distCoeffs 4, 5, 8, 12 or 14 numbers"),
        ({"distCoeffs": [0] * 12 + [0.1, 0]}, "tilted sensor"),
        ({"fisheye": 1}, "fisheye camera has 4"),
        ({"calibrationSigma": [0.1]}, "must be 3x3"),
        ({"calibrationSigma": [-0.1, 1]}, "calibration_sigma needs"),
        ({"Nu": "wide"}, "Nu and Nv integers"),
        ({"Nu": None}, "Nu and Nv integers"),
        ({"Nu": 0}, "camera.json: .*positive size"),
        ({"Nv": 1200.5}, "Nu and Nv integers"),
    ],
)
def test_a_value_of_the_wrong_kind_is_one_sentence_with_the_file(tmp_path, change, message):
    with pytest.raises(InputError, match=message) as error:
        Camera.from_speed_json(write(tmp_path, speed_json(CAMERA) | change))
    assert "camera.json" in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [("", "not readable as JSON"), ("{", "not readable as JSON"), ("[1, 2]", "one JSON object, found list")],
)
def test_a_file_that_is_no_json_object_is_refused(tmp_path, content, message):
    with pytest.raises(InputError, match=message):
        Camera.from_speed_json(write(tmp_path, content))


def test_a_missing_file_is_named():
    with pytest.raises(InputError, match=r"nowhere\.json: no such file"):
        Camera.from_speed_json("nowhere.json")
