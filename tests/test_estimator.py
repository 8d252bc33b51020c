"""Image in, pose out: what the estimator refuses, and that every runtime reads the same weights alike."""

import json

import numpy as np
import pytest
import torch

from proxnav.detection.heatmap.config import HeatmapNetConfig, HeatmapSettings
from proxnav.detection.heatmap.export import FindTarget, ReadKeypoints, export
from proxnav.detection.heatmap.finder import FinderNet
from proxnav.detection.heatmap.network import HeatmapNet
from proxnav.detection.sessions import open_session
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.models.card import ModelCard, write_card
from proxnav.records import Keypoints
from proxnav.targets.space_rider import space_rider

CAMERA = Camera(256, 192, 350.0, 350.0, 128.0, 96.0)
SIDE = 64


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """A model folder of small untrained networks."""
    torch.manual_seed(1)
    folder, target = tmp_path_factory.mktemp("model"), space_rider()
    net = HeatmapNet(HeatmapNetConfig("resnet10", 16), 24)
    with torch.no_grad():
        net.logits.weight.mul_(300.0)  # clear peaks, as a trained network has
    export(ReadKeypoints(net), ReadKeypoints.OUTPUTS, SIDE, folder, "crop")
    export(FindTarget(FinderNet(width=16)), ("probability",), SIDE, folder, "finder")
    settings = HeatmapSettings(SIDE, SIDE)
    write_card(folder, ModelCard(target.name, target.keypoint_names, target.keypoints_m, settings))
    return folder


def noise(dtype=np.uint8, shape=(192, 256)):
    return np.random.default_rng(2).integers(0, np.iinfo(dtype).max, shape, dtype=dtype)


def test_onnx_runtime_reads_what_torch_reads(model):
    crops = np.stack([noise(shape=(SIDE, SIDE)), noise(shape=(SIDE, SIDE))[::-1]])
    net = HeatmapNet(HeatmapNetConfig("resnet10", 16), 24)
    from safetensors.torch import load_file

    reader = ReadKeypoints(net).eval()
    reader.load_state_dict({key: value.float() for key, value in load_file(model / "crop.safetensors").items()})
    with torch.inference_mode():
        wanted = reader(torch.from_numpy(crops.copy()))
    for name, got, want in zip(
        ReadKeypoints.OUTPUTS, open_session(model / "crop.onnx", "onnxruntime")(crops), wanted, strict=True
    ):
        np.testing.assert_allclose(got, want, rtol=1e-3, atol=1e-2, err_msg=name)  # px


def test_the_weights_are_stored_once(model):
    graph, weights = (model / "crop.onnx").stat().st_size, (model / "crop.safetensors").stat().st_size
    assert graph < 0.1 * weights


@pytest.mark.parametrize("image", [np.zeros((192, 256), np.uint8), np.full((192, 256), 255, np.uint8)])
def test_a_blank_image_is_a_status_and_not_a_pose(model, image):
    result = PoseEstimator.load(str(model), "onnxruntime")(image, CAMERA)
    assert result.status == "bad_image"
    assert result.T_cam_target is None


@pytest.mark.parametrize(
    "image", [noise(), noise(np.uint16), noise(shape=(192, 256, 3)), noise(np.uint16, (192, 256, 3))]
)
def test_every_kind_of_image_ends_in_a_status(model, image):
    """Of untrained networks nothing better can be asked: what trained ones say to noise stands in test_shipped.py."""
    result = PoseEstimator.load(str(model), "onnxruntime")(image, CAMERA)
    assert result.status in ("ok", "no_target", "no_consensus", "too_few_points", "behind_camera")
    assert (result.T_cam_target is None) == (result.status != "ok")


def test_an_image_of_another_size_than_the_camera_is_refused(model):
    with pytest.raises(InputError, match=r"256x100 px.*camera 256x192"):
        PoseEstimator.load(str(model), "onnxruntime")(noise(shape=(100, 256)), CAMERA)


def test_an_unknown_model_names_the_shipped_ones():
    with pytest.raises(InputError, match="no model 'hubbel'"):
        PoseEstimator.load("hubbel")


def test_a_model_card_without_its_detector_is_refused(model, tmp_path):
    card = json.loads((model / "model.json").read_text())
    del card["detector"]
    (tmp_path / "model.json").write_text(json.dumps(card))
    with pytest.raises(InputError, match="detector"):
        PoseEstimator.load(str(tmp_path))


def test_a_damaged_graph_is_refused(model, tmp_path):
    for name in ("model.json", "crop.onnx", "crop.safetensors"):
        (tmp_path / name).write_bytes((model / name).read_bytes())
    (tmp_path / "finder.onnx").write_bytes(b"not a graph")
    with pytest.raises(InputError, match=r"finder\.onnx"):
        PoseEstimator.load(str(tmp_path), "onnxruntime")


def test_true_keypoints_give_the_true_pose_with_its_covariance(model, rng):
    estimator = PoseEstimator.load(str(model), "onnxruntime")
    T = Pose.from_wxyz("cam", "target", quaternion.random(rng, 1)[0], [0.5, -0.3, 30.0])
    pixels = CAMERA.project(T @ estimator.points_target_m)
    n = len(pixels)
    keypoints = Keypoints("ok", pixels, np.tile(np.eye(2) * 0.01, (n, 1, 1)), np.ones(n), np.full(4, np.nan))
    result = estimator.solve(keypoints, CAMERA)
    assert result.status == "ok"
    np.testing.assert_allclose(result.T_cam_target.matrix(), T.matrix(), atol=1e-5)
    assert (np.linalg.eigvalsh(result.covariance) > 0).all()


@pytest.mark.parametrize(
    "change", [["a", "list"], {"detector": "guess"}, {"detector": ["heatmap"]}, {"keypoints_m": [[1, 2], [3]]},
               {"keypoints_m": [[10**400, 0, 0]]}, {"settings": 3}, {"keypoint_names": ["one"]}],
)  # fmt: skip
def test_a_model_card_of_another_shape_is_refused(model, tmp_path, change):
    for path in model.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    card = json.loads((model / "model.json").read_text())
    (tmp_path / "model.json").write_text(json.dumps(change if isinstance(change, list) else card | change))
    with pytest.raises(InputError, match=r"model\.json"):
        PoseEstimator.load(str(tmp_path), "onnxruntime")


def test_fewer_threads_than_none_are_refused(model):
    with pytest.raises(InputError, match="threads"):
        PoseEstimator.load(str(model), threads=-1)
