"""Our modules wired with Basilisk's own: frames, messages and what they refuse."""

from typing import Any

import numpy as np
import pytest

from boxcraft import boxcraft
from proxnav.benchmarks.servicing_flight import CAMERA_AT, EPOCH, Q_BODY_CAM
from proxnav.benchmarks.servicing_loop import loop_camera
from proxnav.errors import InputError
from proxnav.geometry import Pose, quaternion
from proxnav.images.codecs import decode_image, encode_png
from proxnav.live.basilisk.attitude import q_n_b, sigma_bn
from proxnav.records import PoseResult

pytest.importorskip("Basilisk", reason="Basilisk is not installed: pip install bsk")

SIZE = 96
R_TARGET = np.array([0.0, 6.9e6, 0.0])
"""Place of the target [m], N axes; the chaser stands 20 m behind it along N's z."""
T_CAM_TARGET = Pose.from_wxyz("cam", "target", [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 20.0])
COVARIANCE = np.diag([1.0, 4.0, 9.0, 1e-4, 1e-4, 1e-4])


class Answering:
    """An estimator that has one answer, and counts."""

    def __init__(self) -> None:
        self.images: list[np.ndarray] = []
        self.skies: list[Any] = []

    def keypoints_and_pose(self, image: np.ndarray, camera: Any, box: Any, sky: Any) -> tuple[None, PoseResult]:
        self.images.append(image)
        self.skies.append(sky)
        return None, PoseResult("ok", T_CAM_TARGET, COVARIANCE, np.ones(4, bool))


def messages() -> Any:
    from Basilisk.architecture import messaging

    return messaging


def states(r: np.ndarray, q_n_body: np.ndarray) -> Any:
    payload = messages().SCStatesMsgPayload()
    payload.r_BN_N, payload.v_BN_N, payload.sigma_BN = r.tolist(), [0.0, 0.0, 7600.0], sigma_bn(q_n_body).tolist()
    return messages().SCStatesMsg().write(payload)


def chaser_body() -> np.ndarray:
    """Attitude of a chaser whose camera has the axes of N."""
    return quaternion.conjugate(Q_BODY_CAM)


def config(size: int = SIZE) -> Any:
    from proxnav.live.basilisk import config_payload

    return messages().CameraConfigMsg().write(config_payload(loop_camera(size), np.array(CAMERA_AT), Q_BODY_CAM))


def chaser_place() -> np.ndarray:
    """Origin of the chaser's body when its camera looks at the target from 20 m."""
    return R_TARGET + np.array([0.0, 0.0, -20.0]) - quaternion.rotate(chaser_body(), np.array(CAMERA_AT))


def image_message(encoded: bytes, t: int) -> tuple[Any, Any]:
    from proxnav.live.basilisk.image_message import KeptImage

    kept = KeptImage(encoded)
    return messages().CameraImageMsg().write(kept.payload(t, 1, 1), t, 1), kept


def sensor(estimator: Answering, image: Any) -> Any:
    from proxnav.live.basilisk import PoseSensor

    module = PoseSensor(estimator)  # type: ignore[arg-type]
    attitude = messages().NavAttMsgPayload()
    attitude.sigma_BN = sigma_bn(chaser_body()).tolist()
    module.kept = (attitude_message := messages().NavAttMsg().write(attitude), camera := config())
    module.imageInMsg.subscribeTo(image)
    module.cameraConfigInMsg.subscribeTo(camera)
    module.chaserAttInMsg.subscribeTo(attitude_message)
    return module


def test_the_true_pose_of_the_messages_is_the_one_that_the_camera_draws() -> None:
    from proxnav.live.basilisk.body_states import true_pose
    from proxnav.live.basilisk.camera_config import mounting_of

    pose = true_pose(
        states(chaser_place(), chaser_body()).read(), states(R_TARGET, quaternion.IDENTITY).read(),
        mounting_of(config().read()),
    )  # fmt: skip
    np.testing.assert_allclose(pose.t_m, [0.0, 0.0, 20.0], atol=1e-6)  # m
    assert quaternion.angle_between(pose.q_wxyz, quaternion.IDENTITY) < 1e-7


def test_a_rendered_image_comes_out_of_basilisks_memory_as_it_was_drawn() -> None:
    from proxnav.live.basilisk import RenderedCamera
    from proxnav.live.basilisk.image_message import image_bytes

    camera = RenderedCamera(boxcraft(), epoch_utc=EPOCH)
    kept = states(chaser_place(), chaser_body()), states(R_TARGET, quaternion.IDENTITY), config()
    for reader, message in zip(
        (camera.chaserStateInMsg, camera.targetStateInMsg, camera.cameraConfigInMsg), kept, strict=True
    ):
        reader.subscribeTo(message)
    camera.Reset(0)
    camera.UpdateState(2_000_000_000)
    written = camera.imageOutMsg.read()
    image = decode_image(image_bytes(written), "CameraImageMsg")
    assert (written.timeTag, written.valid, written.cameraID) == (2_000_000_000, 1, 1)
    assert image.shape == (SIZE, SIZE)
    np.testing.assert_array_equal(image, camera.image)
    middle = image[SIZE // 2 - 4 : SIZE // 2 + 4, SIZE // 2 - 4 : SIZE // 2 + 4]
    assert middle.mean() > image[:8, :8].mean() + 10.0  # the craft is in the middle


def test_an_image_becomes_position_and_attitude_with_covariances_in_three_frames() -> None:
    message, _kept = image_message(encode_png(np.zeros((SIZE, SIZE), np.uint8)), 4_000_000_000)
    module = sensor(Answering(), message)
    module.Reset(0)
    module.UpdateState(4_000_000_000)
    said = module.opNavOutMsg.read()
    assert (said.valid, said.timeTag) == (1, 4.0)
    np.testing.assert_allclose(R_TARGET + np.array(said.r_BN_N), chaser_place(), atol=1e-6)
    np.testing.assert_allclose(np.array(said.covar_C).reshape(3, 3), np.diag([1.0, 4.0, 9.0]), atol=1e-12)
    np.testing.assert_allclose(np.array(said.covar_B).reshape(3, 3), np.diag([9.0, 1.0, 4.0]), atol=1e-12)
    assert quaternion.angle_between(q_n_b(np.array(module.targetAttOutMsg.read().sigma_BN)), quaternion.IDENTITY) < 1e-7


@pytest.mark.parametrize(("content", "fault"), [(b"", "empty"), (b"\x89PNG\r\n\x1a\nrest", "damaged")])
def test_a_bad_image_says_fault_and_the_next_one_is_read(content: bytes, fault: str) -> None:
    from proxnav.live.basilisk.image_message import KeptImage

    estimator = Answering()
    message, _kept = image_message(content, 1)
    module = sensor(estimator, message)
    module.UpdateState(1)
    said = module.opNavOutMsg.read()
    assert (said.valid, said.faultDetected, module.intake.faults) == (0, 1, {fault: 1})
    good = KeptImage(encode_png(np.zeros((SIZE, SIZE), np.uint8)))
    message.write(good.payload(2, 1, 1), 2, 1)
    module.UpdateState(2)
    assert (module.opNavOutMsg.read().valid, len(estimator.images)) == (1, 1)


def test_an_image_is_read_once_however_often_the_module_runs() -> None:
    estimator = Answering()
    message, _kept = image_message(encode_png(np.zeros((SIZE, SIZE), np.uint8)), 1)
    module = sensor(estimator, message)
    for t in (1, 2, 3):
        module.UpdateState(t)
    assert len(estimator.images) == 1


def test_the_sun_of_the_attitude_message_reaches_the_estimator_in_camera_axes() -> None:
    estimator = Answering()
    message, _kept = image_message(encode_png(np.zeros((SIZE, SIZE), np.uint8)), 1)
    module = sensor(estimator, message)
    attitude = messages().NavAttMsgPayload()
    attitude.vehSunPntBdy = [0.5, 0.0, 0.0]
    module.kept[0].write(attitude)
    module.UpdateState(1)
    np.testing.assert_allclose(estimator.skies[0].sun_cam, [0.0, 0.0, 1.0], atol=1e-12)


def test_an_input_that_is_not_wired_is_named() -> None:
    from proxnav.live.basilisk import RenderedCamera

    camera = RenderedCamera(boxcraft(), epoch_utc=EPOCH)
    with pytest.raises(InputError, match="chaserStateInMsg"):
        camera.Reset(0)
