"""Images and cameras as people hand them over: taken where they can mean one thing, else one sentence."""

import numpy as np
import pytest

import proxnav as pn
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.geometry import Camera
from proxnav.images.acceptance import as_image, checked_camera
from proxnav.images.codecs import encode_png
from proxnav.records import Keypoints

CAMERA = Camera(16, 12, 20.0, 20.0, 8.0, 6.0)


@pytest.fixture
def image(rng: np.random.Generator) -> np.ndarray:
    return rng.integers(0, 256, (12, 16, 3), dtype=np.uint8)


class Tensor:
    """What of torch's tensors matters here; torch itself is not needed to run."""

    def __init__(self, array: np.ndarray) -> None:
        self.array = array

    def detach(self) -> "Tensor":
        return self

    def cpu(self) -> "Tensor":
        return self

    def numpy(self) -> np.ndarray:
        return self.array


def test_what_can_mean_one_image_only_is_that_image(image: np.ndarray, tmp_path) -> None:
    path = tmp_path / "a.png"
    path.write_bytes(encode_png(image))
    first = np.moveaxis(image, -1, 0)
    given = {
        "path": path, "text": str(path), "array": image, "channels first": first, "tensor": Tensor(first),
        "float": image / 255.0, "float32": (image / 255.0).astype(np.float32), "int": image.astype(np.int64),
        "batch of one": first[None], "tensor of floats": Tensor(first / 255.0),
    }  # fmt: skip
    for name, one in given.items():
        np.testing.assert_array_equal(as_image(one, CAMERA), image, err_msg=name)


def test_pil_images_are_taken(image: np.ndarray) -> None:
    pil = pytest.importorskip("PIL.Image", reason="Pillow is not installed")
    np.testing.assert_array_equal(as_image(pil.fromarray(image), CAMERA), image)
    np.testing.assert_array_equal(as_image(pil.fromarray(image[..., 0]), CAMERA), image[..., 0])


@pytest.mark.parametrize(
    ("make", "found"),
    [
        (lambda image: np.stack([image] * 2), r"estimator.batch\(images, cameras\)"),
        (lambda image: np.stack([image[..., 0]] * 5), r"estimator.batch\(images, cameras\)"),
        (lambda image: image.astype(np.float64), r"must lie in \[0, 1\], found"),
        (lambda image: image / 127.5 - 1.0, "undo its normalisation"),
        (lambda image: np.full((12, 16), np.nan), r"must lie in \[0, 1\]"),
        (lambda image: image[:6], "the image is 16x6 px, the camera 16x12 px"),
        (lambda image: None, "found NoneType"),
        (lambda image: "no/such.png", "no such image"),
        (lambda image: image.astype(np.int32) - 300, "found int32"),
        (lambda image: image[..., :2], "found shape"),
    ],
)
def test_what_is_no_image_is_one_sentence(make, found: str, image: np.ndarray) -> None:
    with pytest.raises(InputError, match=found) as error:
        as_image(make(image), CAMERA)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("camera", "found"),
    [
        (CAMERA.K, "lacks the image's size"),
        ("camera.json", r"Camera.read\('camera.json'\)"),
        ([CAMERA, CAMERA], r"estimator.batch\(images, cameras\)"),
        (3.0, "found float"),
    ],
)
def test_what_is_no_camera_is_one_sentence(camera, found: str, image: np.ndarray) -> None:
    with pytest.raises(InputError, match=found):
        checked_camera(camera, image)


@pytest.fixture
def estimator() -> PoseEstimator:
    """An estimator that finds nothing."""
    return PoseEstimator(lambda image: Keypoints.none("no_target", 6), np.zeros((6, 3)), ("",) * 6, "x")


def test_the_estimator_says_that_its_arguments_are_exchanged(estimator: PoseEstimator, image: np.ndarray) -> None:
    with pytest.raises(InputError, match=r"exchanged: call estimator\(image, camera\)"):
        estimator(CAMERA, image)
    with pytest.raises(InputError, match="a matrix K"):
        estimator(image, CAMERA.K)
    assert estimator(image / 255.0, CAMERA).status == "no_target"


def test_a_batch_is_one_pose_each(estimator: PoseEstimator, image: np.ndarray) -> None:
    assert [one.status for one in estimator.batch([image, image], CAMERA)] == ["no_target"] * 2
    assert len(estimator.batch(np.stack([image] * 3), [CAMERA] * 3)) == 3
    with pytest.raises(InputError, match="2 images but 1 cameras"):
        estimator.batch([image, image], [CAMERA])


def test_exchanged_points_and_pixels_are_said() -> None:
    with pytest.raises(InputError, match=r"exchanged: call estimate_pose\(points_target_m, points_px, camera\)"):
        pn.estimate_pose(np.zeros((6, 2)), np.zeros((6, 3)), CAMERA)
