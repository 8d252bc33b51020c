"""Kernels keep flux and centre, and are as wide as they say, down to a fraction of a pixel."""

import numpy as np
import pytest

from proxnav.sensor import blur


def _moments(image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(centroid [px], covariance [px^2]) of an image's light, in (x, y)."""
    y, x = np.mgrid[: image.shape[0], : image.shape[1]] + 0.5
    points = np.stack([x.ravel(), y.ravel()])
    weights = image.ravel().astype(np.float64) / image.sum(dtype=np.float64)
    centre = points @ weights
    return centre, (weights * (points - centre[:, None])) @ (points - centre[:, None]).T


def _point(size: int = 65) -> np.ndarray:
    image = np.zeros((size, size), dtype=np.float32)
    image[size // 2, size // 2] = 1000.0
    return image


@pytest.mark.parametrize("sigma", [0.2, 0.4, 0.6, 1.0, 3.0])
def test_psf_has_its_width_and_keeps_flux_and_centre(sigma: float):
    image = blur.gaussian(_point(), sigma)
    centre, covariance = _moments(image)
    assert image.sum() == pytest.approx(1000.0, rel=1e-5)
    np.testing.assert_allclose(centre, 32.5, atol=1e-4)  # px
    np.testing.assert_allclose(covariance, sigma**2 * np.eye(2), atol=2e-3 * sigma**2)


@pytest.mark.parametrize("motion", [(0.4, 0.0), (3.0, 0.0), (0.0, 7.3), (4.0, -3.0)])
def test_motion_kernel_is_a_line_of_that_length_and_direction(motion: tuple[float, float]):
    image = blur.convolve(_point(), blur.line_and_disc(motion, 0.0))
    centre, covariance = _moments(image)
    np.testing.assert_allclose(centre, 32.5, atol=1e-4)  # px
    np.testing.assert_allclose(covariance, np.outer(motion, motion) / 12.0, atol=2e-3)  # px^2
    assert image.sum() == pytest.approx(1000.0, rel=1e-5)


@pytest.mark.parametrize("diameter", [0.5, 0.9, 4.0, 11.0])
def test_defocus_disc_has_the_variance_of_its_diameter(diameter: float):
    _, covariance = _moments(blur.convolve(_point(), blur.line_and_disc((0.0, 0.0), diameter)))
    np.testing.assert_allclose(np.diag(covariance), diameter**2 / 16.0, rtol=2e-3)
    assert abs(covariance[0, 1]) < 0.02 * diameter**2 / 16.0


def test_sub_pixel_motion_of_the_mission_is_a_no_op():
    # 4.5 cm/s for 1 ms at 10 m and fx 1774 px: 0.008 px
    assert blur.line_and_disc((0.008, 0.0), 0.0) is None
    image = _point()
    assert blur.gaussian(image, 0.0) is image
    assert blur.convolve(image, None) is image
