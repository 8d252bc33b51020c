"""Image in, pose and covariance out: a detector and the pose solver as one call. Needs no torch."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.datasets.files import read_json, write_json
from proxnav.datasets.records import Keypoints, PoseResult
from proxnav.detection.heatmap.detector import HeatmapDetector
from proxnav.detection.images import check_size
from proxnav.detection.keypoint_rcnn.decode import Calibration
from proxnav.detection.keypoint_rcnn.detect import DetectConfig
from proxnav.detection.keypoint_rcnn.onnx_runtime import load_onnx
from proxnav.detection.sessions import Backend, open_session
from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.geometry.types import Box, Pixels
from proxnav.pose.config import PoseConfig
from proxnav.pose.estimate import estimate_pose

SHIPPED = Path(__file__).parent / "weights"
"""Models that come with the package, a folder each."""

VAGUE_RAD = 0.6
"""Standard deviation of attitude about any axis above which a pose is refused."""
VAGUE_SHARE = 0.5
"""Standard deviation of position over range above which a pose is refused."""


@dataclass(frozen=True)
class PoseEstimator:
    """`estimator(image, camera)` is the pose of the target in the camera frame.

    >>> estimator = PoseEstimator.load("space-rider")  # doctest: +SKIP
    >>> estimator(image, camera).status                # doctest: +SKIP
    'ok'
    """

    detect: Callable[[np.ndarray], Keypoints]
    points_target_m: np.ndarray
    """(n, 3) keypoints in the target frame, in the detector's order."""
    keypoint_names: tuple[str, ...]
    target: str
    """Name of the target that the model knows."""
    pose: PoseConfig = field(default_factory=PoseConfig)
    look_again: Callable[[np.ndarray, Box], Keypoints] | None = None
    """Reads the image in a box [px]; where there is one, the first pose says where to look closer."""
    least_median_score: float = 0.0
    """Of the keypoints that were found: below it the image shows something else (`no_target`), whatever pose fits."""

    @staticmethod
    def load(name_or_path: str, backend: Backend = "auto", threads: int = 0) -> "PoseEstimator":
        """A shipped model by name, or any folder with a `model.json`."""
        folder = _folder(name_or_path)
        card = read_json(folder / "model.json", "the description of a model")
        if not isinstance(card, dict) or card.get("detector") not in list(_DETECTORS):
            raise InputError(f"{folder / 'model.json'}: expected a detector among {', '.join(_DETECTORS)}")
        try:
            return _assemble(folder, card, backend, threads)
        except InputError:
            raise
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            raise InputError(
                f"{folder / 'model.json'}: {type(error).__name__} {error}; export the model again"
            ) from None

    def __call__(self, image: np.ndarray, camera: Camera) -> PoseResult:
        """Pose from one image (uint8 or uint16, grey or RGB) of the camera's size."""
        return self.observe(image, camera)[1]

    def observe(self, image: np.ndarray, camera: Camera) -> tuple[Keypoints, PoseResult]:
        """As calling the estimator, with the keypoints that the pose rests on."""
        check_size(image, camera)
        first = self._observe(self.detect(image), camera)
        second = self._closer(image, camera, first[1].T_cam_target)
        keypoints, result = first if second is None or second[1].T_cam_target is None else second
        if result.T_cam_target is not None and median_score(keypoints) < self.least_median_score:
            result = PoseResult.failure("no_target", len(self.points_target_m))
        return keypoints, result

    def _closer(
        self, image: np.ndarray, camera: Camera, T_cam_target: Pose | None
    ) -> tuple[Keypoints, PoseResult] | None:
        """A second look where a first pose puts the target; None when there is nothing to look at."""
        if self.look_again is None or T_cam_target is None:
            return None
        box = box_in_image(camera.project(T_cam_target @ self.points_target_m), camera)
        return None if box is None else self._observe(self.look_again(image, box), camera)

    def _observe(self, keypoints: Keypoints, camera: Camera) -> tuple[Keypoints, PoseResult]:
        if keypoints.status != "ok":
            return keypoints, PoseResult.failure(keypoints.status, len(self.points_target_m))
        return keypoints, self.solve(keypoints, camera)

    def solve(self, keypoints: Keypoints, camera: Camera) -> PoseResult:
        """Pose from keypoints that were detected before."""
        result = estimate_pose(
            self.points_target_m, keypoints.pixels, camera, keypoints.covariances_px2, keypoints.scores, self.pose
        )
        return PoseResult.failure("no_consensus", len(result.inliers)) if _is_vague(result) else result


def median_score(keypoints: Keypoints) -> float:
    """Median score of the keypoints that were found; 0 when there are none."""
    found = keypoints.scores[keypoints.scores > 0.0]
    return float(np.median(found)) if found.size else 0.0


def box_in_image(pixels: Pixels, camera: Camera) -> Box | None:
    """The box of projected points, cut at the image's edges; None when nothing of it is in the image."""
    size = np.array([camera.width, camera.height], dtype=np.float64)
    box = np.concatenate([np.clip(np.nanmin(pixels, axis=0), 0.0, size), np.clip(np.nanmax(pixels, axis=0), 0.0, size)])
    return box if (box[2:] - box[:2]).min() > 1.0 else None


def _is_vague(result: PoseResult) -> bool:
    """Whether a pose claims to know so little that it says nothing: keypoints of an image without the target."""
    if result.T_cam_target is None or result.covariance is None:
        return False
    sigma = np.sqrt(np.diag(result.covariance))
    return bool(sigma[3:].max() > VAGUE_RAD or sigma[:3].max() > VAGUE_SHARE * np.linalg.norm(result.T_cam_target.t_m))


def shipped_models() -> list[str]:
    """Names of the models in the package."""
    return sorted(path.parent.name for path in SHIPPED.glob("*/model.json"))


def _folder(name_or_path: str) -> Path:
    for folder in (SHIPPED / name_or_path, Path(name_or_path)):
        if (folder / "model.json").is_file():
            return folder
    raise InputError(
        f"no model '{name_or_path}': neither a shipped one ({', '.join(shipped_models()) or 'none'}) "
        "nor a folder with a model.json"
    )


def _assemble(folder: Path, card: dict[str, Any], backend: Backend, threads: int) -> PoseEstimator:
    points = np.array(card["keypoints_m"], dtype=np.float64).reshape(-1, 3)
    names = tuple(str(name) for name in card["keypoint_names"])
    if len(names) != len(points):
        raise InputError(f"{folder / 'model.json'}: {len(names)} keypoint names for {len(points)} keypoints")
    detect = _DETECTORS[card["detector"]](folder, card, backend, threads)
    # Of many keypoints a handful always agrees by chance, in an image that shows something else altogether.
    pose = PoseConfig(min_inliers=max(4, len(points) // 3), min_inlier_share=0.6)
    look_again = detect if isinstance(detect, HeatmapDetector) else None
    least = float(card.get("least_median_score", 0.0))
    return PoseEstimator(detect, points, names, card["target"], pose, look_again, least)


def _heatmap(folder: Path, card: dict[str, Any], backend: Backend, threads: int) -> HeatmapDetector:
    return HeatmapDetector(
        find=open_session(folder / "finder.onnx", backend, threads),
        read=open_session(folder / "crop.onnx", backend, threads),
        n_keypoints=len(card["keypoint_names"]),
        **card["settings"],
    )


def _keypoint_rcnn(
    folder: Path, card: dict[str, Any], backend: Backend, threads: int
) -> Callable[[np.ndarray], Keypoints]:
    settings = card["settings"]
    config = DetectConfig(settings["min_score"], settings["looks"], Calibration(**settings["calibration"]))
    network = load_onnx(folder / "keypoint-rcnn.onnx", threads)
    return lambda image: network.predict(image, config)


_DETECTORS: dict[str, Callable[[Path, dict[str, Any], Backend, int], Callable[[np.ndarray], Keypoints]]] = {
    "heatmap": _heatmap,
    "keypoint-rcnn": _keypoint_rcnn,
}


def write_model_card(folder: Path, card: dict[str, Any]) -> None:
    """The `model.json` that `PoseEstimator.load` reads."""
    write_json(folder / "model.json", card, indent=1)
