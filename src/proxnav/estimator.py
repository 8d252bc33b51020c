"""Image in, pose and covariance out: a detector and the pose solver as one call. Needs no torch."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.detection.heatmap.detector import HeatmapDetector
from proxnav.detection.keypoint_rcnn.decode import Calibration
from proxnav.detection.keypoint_rcnn.detect import DetectConfig
from proxnav.detection.keypoint_rcnn.onnx_runtime import load_onnx
from proxnav.detection.sessions import Backend, open_session
from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.geometry.boxes import box_in_image
from proxnav.geometry.types import Box
from proxnav.images.size import check_size
from proxnav.images.tones import grey_8_bit
from proxnav.pose.align import AlignConfig, Alignment, Prior, align
from proxnav.pose.solve.config import PoseConfig
from proxnav.pose.solve.estimate import estimate_pose
from proxnav.records import Keypoints, PoseResult
from proxnav.storage.files import read_json, write_json
from proxnav.targets import Target
from proxnav.targets.loading import load_target

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
    shape: Target | None = None
    """Mesh whose outline is laid onto the image's edges; None leaves the pose as the keypoints say it."""
    alignment: AlignConfig = field(default_factory=AlignConfig)

    @staticmethod
    def load(name_or_path: str, backend: Backend = "auto", threads: int = 0) -> "PoseEstimator":
        """A shipped model by name, or any folder with a `model.json`."""
        folder, card = _read_card(_folder(name_or_path))
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

    def observe(self, image: np.ndarray, camera: Camera, box: Box | None = None) -> tuple[Keypoints, PoseResult]:
        """As calling the estimator, with the keypoints that the pose rests on.

        `box` [px]: where somebody knows the target to be, a navigation filter for one; nothing is searched then.
        """
        check_size(image, camera)
        grey = grey_8_bit(image)
        keypoints, result = self._read(grey, camera, box)
        found = self._aligned(grey, camera, keypoints, result)
        if found is None:
            return keypoints, result
        if found.edge_share < self.alignment.least_edge_share:
            return keypoints, PoseResult.failure("no_consensus", len(result.inliers))
        return keypoints, replace(result, T_cam_target=found.T_cam_target, covariance=found.covariance)

    def alignment_of(self, image: np.ndarray, camera: Camera) -> Alignment | None:
        """How the pose of an image was laid onto it; None where there is no pose or it stayed that of the keypoints."""
        grey = grey_8_bit(image)
        return self._aligned(grey, camera, *self._read(grey, camera, None))

    def _read(self, grey: np.ndarray, camera: Camera, box: Box | None) -> tuple[Keypoints, PoseResult]:
        """Keypoints and their pose from the box, or from a search; `no_target` where the keypoints are unsure."""
        if box is not None and self.look_again is not None:
            keypoints, result = self._observe(self.look_again(grey, box), camera)
        else:
            keypoints, result = self._search(grey, camera)
        if result.T_cam_target is not None and keypoints.median_score < self.least_median_score:
            result = PoseResult.failure("no_target", len(self.points_target_m))
        return keypoints, result

    def _search(self, grey: np.ndarray, camera: Camera) -> tuple[Keypoints, PoseResult]:
        """A first look and, where there is something, a closer second one."""
        first = self._observe(self.detect(grey), camera)
        second = self._closer(grey, camera, first[1].T_cam_target)
        return first if second is None or second[1].T_cam_target is None else second

    def _aligned(self, grey: np.ndarray, camera: Camera, keypoints: Keypoints, result: PoseResult) -> Alignment | None:
        """The keypoint pose laid onto the image."""
        if self.shape is None or result.T_cam_target is None or result.covariance is None:
            return None
        prior = Prior.of(result.T_cam_target, result.covariance, 1.0 - keypoints.median_score)
        return align(grey, camera, self.shape, prior, self.alignment)

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


def consensus_for(n_keypoints: int) -> PoseConfig:
    """How many keypoints must agree: of many, a handful always does by chance, whatever the image shows."""
    return PoseConfig(min_inliers=max(4, n_keypoints // 3), min_inlier_share=0.6)


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


def _read_card(folder: Path) -> tuple[Path, dict[str, Any]]:
    """(folder of the networks, description); a description may be `based_on` a shipped model and name what differs."""
    card = read_json(folder / "model.json", "the description of a model")
    if isinstance(card, dict) and card.get("based_on") in shipped_models():
        base, base_card = _read_card(SHIPPED / card["based_on"])
        return base, base_card | {key: value for key, value in card.items() if key != "based_on"}
    if not isinstance(card, dict) or card.get("detector") not in list(_DETECTORS):
        raise InputError(f"{folder / 'model.json'}: expected a detector among {', '.join(_DETECTORS)}")
    return folder, card


def _assemble(folder: Path, card: dict[str, Any], backend: Backend, threads: int) -> PoseEstimator:
    points = np.array(card["keypoints_m"], dtype=np.float64).reshape(-1, 3)
    names = tuple(str(name) for name in card["keypoint_names"])
    if len(names) != len(points):
        raise InputError(f"{folder / 'model.json'}: {len(names)} keypoint names for {len(points)} keypoints")
    detect = _DETECTORS[card["detector"]](folder, card, backend, threads)
    look_again = detect if isinstance(detect, HeatmapDetector) and card.get("looks", 2) > 1 else None
    least = float(card.get("least_median_score", 0.0))
    shape = _shape(folder, card) if card.get("alignment") is not None else None
    alignment = AlignConfig(**(card.get("alignment") or {}))
    return PoseEstimator(
        detect, points, names, card["target"], consensus_for(len(points)), look_again, least, shape, alignment
    )


def _shape(folder: Path, card: dict[str, Any]) -> Target:
    """The target that lies in the model's folder, or the generated one of that name."""
    beside = folder / "target"
    return load_target(str(beside) if beside.is_dir() else str(card["target"]))


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
