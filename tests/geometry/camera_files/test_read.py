"""Calibration files of every maker: each projects as the library that it comes from, and damage is one sentence."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from proxnav.errors import InputError, InputNote
from proxnav.geometry import Camera
from proxnav.geometry.camera_files import read_camera_file

FILES = Path(__file__).parents[2] / "data" / "cameras"
K = np.array([[3100.0, 0.0, 1223.5], [0.0, 3102.0, 1020.2], [0.0, 0.0, 1.0]])
WIDE = np.array([[1060.0, 0.0, 1223.5], [0.0, 1061.0, 1020.2], [0.0, 0.0, 1.0]])
BROWN = (-0.12, 0.08, 4e-4, -3e-4, 0.01)
RATIONAL = (0.31, 0.02, 4e-4, -6e-4, 0.001, 0.66, 0.08, 0.003)
PRISM = (-0.12, 0.04, 4e-4, -6e-4, 0.02, 0.05, 0.02, 0.001, 2e-3, -1e-4, -3e-3, 2e-4)
FISHEYE = (-0.02, 0.006, -0.004, 0.0008)


@pytest.mark.parametrize(
    ("name", "matrix", "k"),
    [
        ("opencv.yaml", K, BROWN),
        ("opencv.xml", K, BROWN),
        ("opencv.json", K, BROWN),
        ("opencv.npz", K, BROWN),
        ("opencv_rational.yaml", K, RATIONAL),
        ("opencv_thin_prism.xml", K, PRISM),
        ("opencv_fisheye.yaml", WIDE, FISHEYE),
        ("ros_camera_info.yaml", K, BROWN),
        ("kalibr_camchain.yaml#cam0", K, BROWN[:4]),
        ("kalibr_camchain.yaml#cam1", WIDE, FISHEYE),
        ("matlab.json", K, BROWN[:4]),
        ("matlab_structure.mat", K, BROWN),
        ("matlab_variables.mat", K, BROWN),
        ("plain.json", K, BROWN[:4]),
    ],
)
def test_a_file_projects_as_the_library_that_wrote_it(name, matrix, k, rng):
    camera = read_camera_file(FILES / name).camera
    assert (camera.width, camera.height) == (2448, 2048)
    points = rng.uniform([-0.3, -0.3, 1.0], [0.3, 0.3, 1.2], (200, 3)) * rng.uniform(1.0, 50.0, (200, 1))
    if k is FISHEYE:
        theirs, _ = cv2.fisheye.projectPoints(points[:, None], np.zeros(3), np.zeros(3), matrix, np.array(k))
        theirs = theirs[:, 0]
    else:
        theirs = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, np.array(k))[0][:, 0]
    np.testing.assert_allclose(camera.project(points), theirs + 0.5, atol=1e-6)


def test_the_origin_of_pixels_is_said():
    assert read_camera_file(FILES / "opencv.yaml").notes == (
        "principal point converted from pixel centres (1223.5, 1020.2 -> 1224, 1020.7 px)",
    )
    assert (
        "MATLAB's pixel centres, counted from 1 (1224.5, 1021.2 -> 1224"
        in read_camera_file(FILES / "matlab.json").notes[0]
    )
    assert read_camera_file(FILES / "speedplus.json").notes == ()


def test_a_camera_that_is_read_says_so_with_the_file():
    with pytest.warns(InputNote, match=r"opencv\.xml: principal point converted from pixel centres"):
        assert Camera.read(FILES / "opencv.xml").cx == 1224.0


def test_speed_plus_files_keep_their_origin():
    assert Camera.read(FILES / "speedplus.json") == Camera.from_speed_json(FILES / "speedplus.json")


def test_a_ros_message_is_the_camera_of_the_region_that_is_delivered_and_binned():
    found = read_camera_file(FILES / "ros_message.yaml")
    camera = found.camera
    assert (camera.width, camera.height) == (1000, 800)
    assert (camera.fx, camera.fy) == (1550.0, 1551.0)
    assert (camera.cx, camera.cy) == ((1224.0 - 200.0) / 2.0, pytest.approx((1020.7 - 100.0) / 2.0))
    assert camera.distortion == RATIONAL
    assert "camera of the region of 2000 x 1600 px at (200, 100)" in found.notes
    assert "binned 2 x 2 to 1000 x 800 px" in found.notes


def test_binning_that_does_not_divide_the_image_keeps_the_scale_of_a_bin(tmp_path):
    text = (FILES / "ros_camera_info.yaml").read_text() + "binning_x: 3\nbinning_y: 3\n"
    (tmp_path / "info.yaml").write_text(text)
    camera = read_camera_file(tmp_path / "info.yaml").camera
    assert (camera.width, camera.height) == (816, 682)
    assert camera.fy == pytest.approx(3102.0 / 3.0)


def test_the_projection_matrix_of_rectified_images_is_told_from_the_camera():
    notes = read_camera_file(FILES / "ros_camera_info.yaml").notes
    assert any("rectified ones have projection_matrix (fx 3012.4 px)" in note for note in notes)


def test_one_of_several_cameras_must_be_named():
    with pytest.raises(InputError, match=r"holds the cameras cam0, cam1; name one, as in .*#cam0"):
        Camera.read(FILES / "kalibr_camchain.yaml")
    with pytest.raises(InputError, match="no camera 'cam7', found cam0, cam1"):
        Camera.read(f"{FILES / 'kalibr_camchain.yaml'}#cam7")


PLAIN = {"width": 640, "height": 480, "fx": 600.0, "fy": 601.0, "cx": 320.0, "cy": 240.0}


def read(tmp_path, content, name="camera.json"):
    path = tmp_path / name
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return read_camera_file(path)


@pytest.mark.parametrize(
    ("change", "cx", "note"),
    [
        ({}, 320.0, None),
        ({"cx": 319.5, "cy": 239.5}, 320.0, "converted from pixel centres"),
        ({"cx": 319.5, "cy": 241.2}, 320.0, "converted from pixel centres"),
        ({"cx": 318.2, "cy": 241.3}, 318.2, "taken as counted from the corner"),
        ({"cx": 318.2, "cy": 241.3, "pixel_origin": "corner"}, 318.2, None),
        ({"cx": 318.2, "cy": 241.3, "pixel_origin": "centre"}, 318.7, "converted from pixel centres"),
    ],
)
def test_plain_numbers_say_or_show_where_their_pixels_begin(tmp_path, change, cx, note):
    found = read(tmp_path, PLAIN | change)
    assert found.camera.cx == cx
    assert (note is None and found.notes == ()) or note in found.notes[0]


def test_errors_of_the_calibration_are_read(tmp_path):
    found = read(tmp_path, PLAIN | {"calibration_sigma": {"focal": 0.002, "principal_px": 1.5}})
    assert (found.camera.calibration_sigma.focal, found.camera.calibration_sigma.principal_px) == (0.002, 1.5)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({k: v for k, v in PLAIN.items() if k != "width"}, "size of the image is missing; add width and height"),
        ({k: v for k, v in PLAIN.items() if k != "cy"}, "fx, fy, cx and cy are needed"),
        (PLAIN | {"cx": 319.5}, "by two different origins of pixels; say which"),
        (PLAIN | {"resolution": [480, 640]}, "contradict each other as the size"),
        (PLAIN | {"fx": 0.0176, "fy": 0.0176}, "give the focal length in pixels"),
        (PLAIN | {"distortion": [0.1] * 4, "k1": 0.1}, "both as a list and as k1"),
        (PLAIN | {"distortion": [0.1] * 6}, "4, 5, 8, 12 or 14 distortion coefficients in OpenCV's order, found 6"),
        (PLAIN | {"cx": 2000.0, "pixel_origin": "corner"}, "far outside the image"),
        (PLAIN | {"projection": "omni"}, "lens model 'omni' is not read"),
        (PLAIN | {"distortion": [-4.0, 0, 0, 0]}, "the lens folds .* no ray leads to .* % of the image"),
        ({"K": [[600, 3, 320], [0, 600, 240], [0, 0, 1]], "width": 640, "height": 480}, "skew of 3 px"),
        ({"K": [[0, 0, 0]] * 3, "width": 640, "height": 480}, "not calibrated yet"),
        ({"K": K.tolist(), "mtx": WIDE.tolist(), "width": 640, "height": 480}, "K and mtx contradict each other"),
        (
            {"K": K.tolist(), "D": [0.1] * 8, "distortion_model": "plumb_bob", "width": 9, "height": 9},
            "plumb_bob has 4",
        ),
        ({"K": K.tolist(), "dist": [0.1] * 5}, "size of the image is missing; add image_width and image_height"),
        ({"names": 3}, "no camera in it, found names; expected camera_matrix"),
        ("[1, 2]", "holds no named values"),
        ("{", "not readable as JSON, YAML, XML"),
        ("<a", "not readable as JSON, YAML, XML"),
        ("<!DOCTYPE a><a>1</a>", "XML with a document type"),
        ("a: [1, 2", "not readable as JSON, YAML, XML"),
        ("!!python/object/apply:os.system ['true']", "not readable as JSON, YAML, XML"),
    ],
)
def test_what_is_missing_or_contradicts_itself_is_one_sentence(tmp_path, content, message):
    with pytest.raises(InputError, match=message) as error:
        read(tmp_path, content)
    assert "camera.json" in str(error.value)
    assert "\n" not in str(error.value)


def test_matlab_values_that_contradict_each_other_are_refused(tmp_path):
    content = json.loads((FILES / "matlab.json").read_text())
    with pytest.raises(InputError, match="IntrinsicMatrix, FocalLength and PrincipalPoint contradict"):
        read(tmp_path, content | {"FocalLength": [3200, 3102]})
    with pytest.raises(InputError, match="ImageSize is empty"):
        read(tmp_path, content | {"ImageSize": []})
    with pytest.raises(InputError, match="fisheyeIntrinsics are not read"):
        read(tmp_path, {"MappingCoefficients": [1, 2, 3, 4]})


def test_a_lens_that_folds_at_the_rim_of_its_image_is_said(tmp_path):
    found = read(tmp_path, PLAIN | {"distortion": [-1.0, 0.0, 0.0, 0.0]})  # grows up to r = 1 / sqrt(3), 231 px
    (note,) = found.notes
    assert note.startswith("the lens folds 23")
    assert "% of the image, beyond it, is left without rays" in note


def test_files_of_other_kinds_are_refused(tmp_path):
    np.save(tmp_path / "K.npy", K)
    with pytest.raises(InputError, match="a bare array; save an npz with K, dist, width and height"):
        read_camera_file(tmp_path / "K.npy")
    np.savez(tmp_path / "K.npz", K=np.array([K, None], dtype=object), allow_pickle=True)
    with pytest.raises(InputError, match=r"K\.npz: not readable"):
        read_camera_file(tmp_path / "K.npz")
    with pytest.raises(InputError, match=r"nowhere\.yaml: no such file"):
        read_camera_file("nowhere.yaml")


@pytest.mark.parametrize("path", sorted(FILES.iterdir()), ids=lambda path: path.name)
def test_a_damaged_file_is_a_camera_or_one_sentence(path, tmp_path):
    whole = path.read_bytes()

    @settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
    @given(st.data())
    def check(data):
        damaged = bytearray(whole)
        for _ in range(data.draw(st.integers(1, 4))):
            damaged[data.draw(st.integers(0, len(damaged) - 1))] = data.draw(st.integers(0, 255))
        (tmp_path / "damaged").write_bytes(damaged[: data.draw(st.integers(0, len(damaged)))])
        refusal = ""
        try:
            read_camera_file(tmp_path / "damaged").camera.project(np.array([0.1, 0.2, 5.0]))
        except InputError as error:
            refusal = str(error)
        assert "\n" not in refusal

    check()
