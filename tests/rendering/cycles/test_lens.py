"""Resampling a pinhole picture through the lens keeps places, sums and sharpness."""

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.records import Window
from proxnav.rendering.cycles import lens

BARREL = Camera(320, 256, 450.0, 430.0, 164.1, 121.4, (-0.22, 0.2, 1e-3, -5e-4, 0.0))
FISHEYE = Camera(320, 256, 450.0, 430.0, 164.1, 121.4, (-0.02, 0.006, -0.004, 0.0008), "fisheye")
WINDOW = Window(30, 40, 200, 150)


def spot(view: Camera, xy: np.ndarray, sigma_px: float) -> np.ndarray:
    """A Gaussian spot in a pinhole picture, about the normalised point xy."""
    x, y = np.meshgrid(np.arange(view.width) + 0.5, np.arange(view.height) + 0.5)
    cx, cy = xy * (view.fx, view.fy) + (view.cx, view.cy)
    light = np.exp(-((x - cx) ** 2 + (y - cy) ** 2) / (2.0 * sigma_px**2))
    return np.repeat(light[..., None], 4, axis=-1).astype(np.float32)


@pytest.mark.parametrize("camera", [BARREL, FISHEYE], ids=["barrel", "fisheye"])
@pytest.mark.parametrize("pixel", [(50.3, 60.7), (130.0, 115.0), (210.9, 170.2)])
def test_a_spot_arrives_where_the_camera_projects_it(pixel, camera):
    pinhole = lens.pinhole_for(camera, WINDOW, 2)
    assert pinhole is not None
    ray = camera.unproject(np.array(pixel))
    image = lens.through_lens(spot(pinhole.camera, ray[:2], 4.0), pinhole, camera)[..., 0]
    at = lens.centres_px(WINDOW)
    centroid = (image[..., None] * at).sum(axis=(0, 1)) / image.sum()
    np.testing.assert_allclose(centroid, pixel, atol=0.01)  # px


@pytest.mark.parametrize("oversampling", [2, 3])
def test_without_bending_the_pixels_are_boxes_again(oversampling, rng):
    bent = Camera(64, 64, 4000.0, 4000.0, 32.0, 32.0, (1e-9, 0.0, 0.0, 0.0, 0.0))
    pinhole = lens.pinhole_for(bent, Window(8, 8, 40, 40), oversampling)
    assert pinhole is not None
    view, n = pinhole.camera, oversampling
    picture = rng.uniform(size=(view.height, view.width, 4)).astype(np.float32)
    image = lens.through_lens(picture, pinhole, bent)
    x0, y0 = round(view.cx - (32.0 - 8.0) * n), round(view.cy - (32.0 - 8.0) * n)
    boxes = picture[y0 : y0 + 40 * n, x0 : x0 + 40 * n].reshape(40, n, 40, n, 4).mean(axis=(1, 3))
    assert np.abs(image - boxes).max() < (0.02 if n == 2 else 0.1)


def test_a_pinhole_camera_needs_no_other_picture():
    pinhole = lens.pinhole_for(BARREL.undistorted(), WINDOW, 2)
    assert pinhole == lens.Pinhole(BARREL.undistorted().cropped(30.0, 40.0, 200, 150), WINDOW, 1)


def test_a_lens_too_wide_for_a_pinhole_picture_is_left_to_the_ray_caster():
    wide = Camera(2000, 2000, 660.0, 660.0, 1000.0, 1000.0, (0.0,) * 4, "fisheye")
    with pytest.raises(InputError, match=r"px for so wide a lens, .* --renderer raycast"):
        lens.pinhole_for(wide, Window(0, 0, 2000, 2000), 2)


def test_a_window_that_no_ray_reaches_needs_no_picture():
    folding = Camera(400, 400, 100.0, 100.0, 200.0, 200.0, (-0.5, 0.0, 0.0, 0.0, 0.0))
    assert lens.pinhole_for(folding, Window(0, 0, 8, 8), 2) is None


def test_the_plane_of_a_facet_gives_the_depth_of_a_neighbouring_ray():
    T = Pose.identity("cam", "target")
    normal = np.array([0.6, 0.0, -0.8])
    hit = np.array([1.0, 2.0, 10.0])
    ray = np.array([0.12, 0.21, 1.0])
    depth = lens.plane_depth(hit[None, None], normal[None, None], ray[None, None], T)[0, 0]
    assert normal @ (depth * ray - hit) == pytest.approx(0.0, abs=1e-12)
