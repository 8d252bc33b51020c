"""The camera against OpenCV, its Jacobians against finite differences, its pixels against the half-pixel rule."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from proxnav.errors import InputError
from proxnav.geometry import Camera, fisheye
from proxnav.geometry import distortion as lens
from proxnav.geometry.calibration import CalibrationSigma
from proxnav.geometry.compiled.lens import lens_numbers, project, undistort_pixels

SPEED = (-0.22383016606510672, 0.51409797089106379, -0.00066499611998340662, -0.00021404771667484594,
         -0.13124227429077406)  # fmt: skip
PLAIN = Camera(1024, 1024, 1407.0, 1407.0, 512.0, 512.0)
BENT = Camera(1920, 1200, 2988.58, 2988.34, 960.0, 600.0, SPEED)
WIDE = Camera(1000, 800, 500.0, 510.0, 490.0, 410.0, (-0.3, 0.1, 1e-3, -2e-3, -0.01))
RATIONAL = Camera(1280, 960, 620.0, 622.0, 641.0, 475.0, (0.31, 0.02, 4e-4, -6e-4, 0.001, 0.66, 0.08, 0.003))
PRISM = Camera(1280, 960, 820.0, 822.0, 641.0, 475.0, (-0.12, 0.04, 4e-4, -6e-4, 0.02, 0.05, 0.02, 0.001,
               2e-3, -1e-4, -3e-3, 2e-4))  # fmt: skip
FISHEYE = Camera(1280, 960, 560.0, 561.0, 641.0, 475.0, (-0.02, 0.006, -0.004, 0.0008), "fisheye")
CAMERAS = [PLAIN, BENT, WIDE, RATIONAL, PRISM, FISHEYE]


def pixels_of(camera):
    return arrays(np.float64, 2, elements=st.floats(0.0, 1.0)).map(lambda x: x * [camera.width, camera.height])


def grid(camera, count=12):
    u, v = np.meshgrid(np.linspace(0, camera.width, count), np.linspace(0, camera.height, count))
    return np.stack([u, v], axis=-1).reshape(-1, 2)


def opencvs(points, K, k, projection):
    if projection == "fisheye":
        return cv2.fisheye.projectPoints(points[:, None], np.zeros(3), np.zeros(3), K, k)[0][:, 0]
    return cv2.projectPoints(points, np.zeros(3), np.zeros(3), K, k)[0][:, 0]


@pytest.mark.parametrize("camera", CAMERAS)
def test_projection_is_opencvs_plus_half_a_pixel(camera, rng):
    points = camera.unproject(grid(camera)) * rng.uniform(5.0, 100.0, size=(144, 1))
    K, k = camera.to_opencv()
    theirs = opencvs(points, K, k, camera.projection)
    assert camera.project(points) == pytest.approx(theirs + 0.5, abs=1e-8)
    # Handing our own matrix over without the shift is wrong by exactly that half pixel.
    assert camera.project(points) == pytest.approx(opencvs(points, camera.K, k, camera.projection), abs=1e-8)
    assert K[0, 2] == camera.cx - 0.5


def test_the_first_pixels_centre_is_at_one_half():
    camera = Camera(4, 4, 10.0, 10.0, 2.0, 2.0)
    image = np.zeros((4, 4), np.float32)
    image[0, 0] = 1.0
    K, _ = camera.to_opencv()
    ray = np.linalg.inv(K) @ [0.0, 0.0, 1.0]  # OpenCV's centre of the first pixel is (0, 0)
    assert camera.project(ray) == pytest.approx([0.5, 0.5])
    assert camera.project(np.array([0.0, 0.0, 1.0])).tolist() == [2.0, 2.0]


@pytest.mark.parametrize("camera", CAMERAS)
def test_unprojected_pixels_project_back(camera):
    @given(pixels_of(camera), st.floats(0.1, 1e4))
    def check(pixel, depth):
        ray = camera.unproject(pixel)
        assert ray[2] == 1.0
        assert camera.project(depth * ray) == pytest.approx(pixel, abs=1e-6)

    check()


@pytest.mark.parametrize("camera", CAMERAS)
def test_undistortion_agrees_with_opencv(camera):
    K, k = camera.to_opencv()
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 200, 1e-14)
    inner = grid(camera) * 0.6 + 0.2 * np.array([camera.width, camera.height])
    if camera.projection == "fisheye":
        theirs = cv2.fisheye.undistortPoints((inner - 0.5)[:, None], K, k, criteria=criteria)[:, 0]
    else:
        theirs = cv2.undistortPoints((inner - 0.5)[:, None], K, k, criteria=criteria)[:, 0]
    assert camera.unproject(inner)[:, :2] == pytest.approx(theirs, abs=1e-7)


@pytest.mark.parametrize("camera", CAMERAS)
def test_the_projection_jacobian_agrees_with_finite_differences(camera, rng):
    points = camera.unproject(grid(camera, 6)) * rng.uniform(5.0, 100.0, size=(36, 1))
    J, h = camera.projection_jacobian(points), 1e-5
    assert J.shape == (36, 2, 3)
    for k, d in enumerate(np.eye(3) * h):
        numeric = (camera.project(points + d) - camera.project(points - d)) / (2.0 * h)
        assert J[:, :, k] == pytest.approx(numeric, rel=1e-6, abs=1e-5)


@pytest.mark.parametrize("camera", CAMERAS)
def test_the_lens_jacobian_agrees_with_finite_differences(camera):
    model = fisheye if camera.projection == "fisheye" else lens

    @given(arrays(np.float64, 2, elements=st.floats(-0.5, 0.5)))
    def check(xy):
        J, h = camera.lens_jacobian(xy), 1e-6
        for k, d in enumerate(np.eye(2) * h):
            numeric = (model.distort(xy + d, camera.distortion) - model.distort(xy - d, camera.distortion)) / (2.0 * h)
            assert J[:, k] == pytest.approx(numeric, abs=1e-8)

    check()


@pytest.mark.parametrize("camera", CAMERAS)
def test_compiled_code_projects_and_straightens_alike(camera):
    row, pixels = lens_numbers(camera), grid(camera)
    rays, xy = camera.unproject(pixels), np.empty((len(pixels), 2))
    undistort_pixels(pixels, row, xy)
    assert xy == pytest.approx(rays[:, :2], abs=1e-9)
    ours = [project(np.eye(3), np.zeros(3), 7.0 * ray, row, 1e-3) for ray in rays]
    assert np.array(ours) == pytest.approx(camera.project(7.0 * rays), abs=1e-9)


def test_points_behind_or_beyond_the_fold_project_to_nan():
    assert np.isnan(PLAIN.project(np.array([[1.0, 2.0, -5.0], [0.0, 0.0, 0.0]]))).all()
    barrel = Camera(1000, 1000, 400.0, 400.0, 500.0, 500.0, (-0.3, 0.0, 0.0, 0.0, 0.0))
    fold = lens.fold_radius(barrel.distortion)
    assert fold == pytest.approx(np.sqrt(1.0 / 0.9))  # 1 + 3 k1 r^2 = 0
    rays = np.array([[0.99 * fold, 0.0, 1.0], [1.01 * fold, 0.0, 1.0]])
    assert np.isnan(barrel.project(rays)).any(axis=1).tolist() == [False, True]
    far = 400.0 * fold * (1.0 - 0.3 * fold**2) + 500.0  # the outermost pixel that any ray reaches
    assert not np.isnan(barrel.unproject(np.array([far - 1.0, 500.0]))).any()
    assert np.isnan(barrel.unproject(np.array([far + 1.0, 500.0]))).any()


def test_a_lens_that_grows_everywhere_never_folds():
    assert lens.fold_radius((0.1, 0.05, 0.0, 0.0, 0.01)) == np.inf
    assert lens.fold_radius((0.0, 0.0, 0.0, 0.0, 0.0)) == np.inf


def test_a_rational_lens_folds_at_its_pole_or_where_it_stops_to_grow():
    pole = lens.fold_radius((0.0, 0.0, 0.0, 0.0, 0.0, -0.25, 0.0, 0.0))  # r / (1 - r^2 / 4)
    assert pole == pytest.approx(2.0)
    turn = lens.fold_radius((0.0, 0.0, 0.0, 0.0, 0.0, 0.25, 0.0, 0.0))  # r / (1 + r^2 / 4), greatest at r = 2
    assert turn == pytest.approx(2.0)


def test_a_fisheye_has_no_rays_beyond_89_degrees_or_where_it_folds():
    wide = Camera(1000, 1000, 250.0, 250.0, 500.0, 500.0, (0.0,) * 4, "fisheye")  # equidistant: 250 px a radian
    reach = 250.0 * np.deg2rad(89.0)
    assert np.isfinite(wide.unproject(np.array([500.0 + reach - 0.1, 500.0]))).all()
    assert np.isnan(wide.unproject(np.array([500.0 + reach + 0.1, 500.0]))).any()
    bent = Camera(1000, 1000, 250.0, 250.0, 500.0, 500.0, (-1.0 / 3.0, 0.0, 0.0, 0.0), "fisheye")  # theta - theta^3 / 3
    assert bent.fold_radius == pytest.approx(np.tan(1.0))


def test_coefficients_are_kept_in_the_shortest_form_that_says_the_same():
    def kept(*k):
        return replace(PLAIN, distortion=k).distortion

    assert kept(-0.1, 0.01, 0.0, 0.0) == (-0.1, 0.01, 0.0, 0.0, 0.0)
    assert kept() == (0.0,) * 5
    assert kept(-0.1, 0.01, 0.0, 0.0, 0.2, *(0.0,) * 9) == (-0.1, 0.01, 0.0, 0.0, 0.2)
    assert len(kept(-0.1, 0.01, 0.0, 0.0, 0.2, 0.1, *(0.0,) * 8)) == 8


def test_what_is_not_known_about_a_camera_goes_with_its_crops_and_sizes():
    camera = replace(PLAIN, calibration_sigma=CalibrationSigma(0.01, 2.0))
    small = camera.cropped(10.0, 20.0, 512, 512).resized(256, 256)
    assert small.calibration_sigma == CalibrationSigma(0.01, 1.0)
    with pytest.raises(InputError, match="calibration_sigma needs focal"):
        CalibrationSigma(-0.01, 1.0)


def test_crops_and_resizes_follow_the_corner_origin(rng):
    points = PLAIN.unproject(grid(PLAIN)) * 20.0
    crop = PLAIN.cropped(100.0, 50.0, 256, 128)
    assert crop.project(points) == pytest.approx(PLAIN.project(points) - [100.0, 50.0])
    small = BENT.resized(480, 300)
    points = BENT.unproject(grid(BENT)) * 20.0
    assert small.project(points) == pytest.approx(BENT.project(points) / 4.0)


def test_contains_includes_the_edges_and_refuses_nan():
    pixels = np.array([[0.0, 0.0], [1024.0, 1024.0], [-0.1, 5.0], [5.0, 1024.1], [np.nan, 5.0]])
    assert PLAIN.contains(pixels).tolist() == [True, True, False, False, False]


@pytest.mark.parametrize("camera", CAMERAS)
def test_opencv_form_goes_there_and_back(camera):
    assert Camera.from_opencv(*camera.to_opencv(), camera.width, camera.height, camera.projection) == camera


@pytest.mark.parametrize("batch", [(), (1,), (5,), (2, 3)])
def test_batches_lead(batch, rng):
    points = rng.uniform(-1.0, 1.0, size=(*batch, 3)) + np.array([0.0, 0.0, 20.0])
    for camera in CAMERAS:
        pixels = camera.project(points)
        assert pixels.shape == (*batch, 2)
        assert camera.unproject(pixels).shape == (*batch, 3)
        assert camera.projection_jacobian(points).shape == (*batch, 2, 3)
        assert camera.contains(pixels).shape == batch


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"width": 0}, "positive size and focal length"),
        ({"fx": 0.0}, "positive size and focal length"),
        ({"fy": np.nan}, "positive size and focal length"),
        ({"cx": np.inf}, "finite intrinsics"),
        ({"distortion": (0.1, 0.0, 0.0)}, "4, 5, 8, 12 or 14 distortion coefficients"),
        ({"distortion": (0.1,) * 14}, "tilted sensor"),
        ({"projection": "fisheye"}, "fisheye camera has 4"),
        ({"distortion": (np.nan, 0.0, 0.0, 0.0, 0.0)}, "finite intrinsics"),
    ],
)
def test_cameras_that_cannot_be_are_refused(change, message):
    fields = {"width": 10, "height": 10, "fx": 10.0, "fy": 10.0, "cx": 5.0, "cy": 5.0} | change
    with pytest.raises(InputError, match=message):
        Camera(**fields)
