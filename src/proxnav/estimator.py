"""Image in, pose and covariance out: a detector and the pose solver as one call. Needs no torch."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from proxnav.cluster.carried import Carried
from proxnav.detection.sessions import Backend
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.boxes import box_in_image
from proxnav.geometry.types import Box, GreyImage, Image, Points, Vector3
from proxnav.images.acceptance import as_grey, checked_camera
from proxnav.models.loading import Detect, DetectIn, Model, load_model
from proxnav.pose.align import CLEARLY, AlignConfig, Alignment, Prior, align
from proxnav.pose.solve.config import PoseConfig
from proxnav.pose.solve.estimate import estimate_pose
from proxnav.pose.trust import CheckedBy, Evidence, TrustConfig, judged, saturated_share, verdict_of
from proxnav.records import Keypoints, PoseResult, Sky
from proxnav.targets import Target

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

    detect: Detect
    points_target_m: Points
    """Keypoints in the target frame [m], in the detector's order."""
    keypoint_names: tuple[str, ...]
    target: str
    """Name of the target that the model knows."""
    pose: PoseConfig = field(default_factory=PoseConfig)
    detect_in: DetectIn | None = None
    """Reads a crop round a box [px]; where there is one, the first pose says where to crop once more."""
    least_median_score: float = 0.0
    """Median score of the keypoints found below which the image shows something else (`no_target`)."""
    shape: Target | None = None
    """Mesh whose outline is laid onto the image's edges; None leaves the pose as the keypoints say it."""
    alignment: AlignConfig = field(default_factory=AlignConfig)
    trust: TrustConfig = field(default_factory=TrustConfig)
    checked_by: CheckedBy = "everything"
    """`nothing` returns poses as the alignment leaves them, without `trust`."""

    @staticmethod
    def load(model: str | Carried, backend: Backend = "auto", threads: int = 0) -> "PoseEstimator":
        """A shipped model by name, or any folder with a `model.json`."""
        return _assembled(load_model(model, backend, threads))

    def __call__(
        self, image: Any, camera: Camera, *, sun_cam: Vector3 | None = None, nadir_cam: Vector3 | None = None
    ) -> PoseResult:
        """Pose from one image of the camera's size: an array (uint8 or uint16, grey or RGB), or what can only mean one
        (a path, a PIL image, a torch tensor, channels first, floats in [0, 1]).

        `sun_cam` and `nadir_cam`, directions to the Sun and to Earth's centre in camera axes, let the pose be refined
        and checked by the view that it predicts. `trust` of the result says what all evidence amounts to; a pose that
        is probably hazardous is refused, with a status that says why.
        """
        sky = None if sun_cam is None else Sky(sun_cam, nadir_cam)
        return self.keypoints_and_pose(image, camera, sky=sky)[1]

    def batch(self, images: Sequence[Any], cameras: Camera | Sequence[Camera]) -> list[PoseResult]:
        """Poses of several images, one after the other, each with its camera or all with one."""
        if not isinstance(cameras, Camera):
            cameras = list(cameras)
            if len(cameras) != len(images):
                raise InputError(f"{len(images)} images but {len(cameras)} cameras: give one for each, or one for all")
        else:
            cameras = [cameras] * len(images)
        return [self(image, camera) for image, camera in zip(images, cameras, strict=True)]

    def keypoints_and_pose(
        self, image: Image, camera: Camera, box: Box | None = None, sky: Sky | None = None
    ) -> tuple[Keypoints, PoseResult]:
        """As calling the estimator, with the keypoints that the pose rests on.

        `box` [px]: where somebody knows the target to be, a navigation filter for one; nothing is searched then.
        """
        keypoints, result, evidence = self.unjudged(image, camera, box)
        if evidence is None:
            return keypoints, result
        if sky is not None:
            result, evidence = self.compared(image, camera, result, evidence, sky)
        return keypoints, self.judged(result, evidence)

    def judged(self, result: PoseResult, evidence: Evidence) -> PoseResult:
        """The result with its trust; refused where the evidence says that it is probably hazardous."""
        if result.T_cam_target is None or result.covariance is None:
            return result
        if evidence.view is None and self.trust.calibration is None and self.trust.range_m is None:
            return result
        range_m = float(np.linalg.norm(result.T_cam_target.t_m))
        status, trust, honest = judged(evidence, range_m, result.covariance, self.trust)
        if status != "ok":
            return replace(PoseResult.failure(status, len(result.inliers)), trust=trust, p_value=result.p_value)
        return replace(result, trust=trust, covariance=honest)

    def unjudged(
        self, image: Image, camera: Camera, box: Box | None = None
    ) -> tuple[Keypoints, PoseResult, Evidence | None]:
        """Keypoints and pose before any verdict, with the evidence; None without a pose or where nothing is checked."""
        camera = checked_camera(camera, image)
        grey = as_grey(image, camera)
        keypoints, of_keypoints, found = self._better_look(grey, camera, *self._from_keypoints(grey, camera, box))
        if found is not None and found.edge_share < self.alignment.least_edge_share:
            return keypoints, PoseResult.failure("no_consensus", len(of_keypoints.inliers)), None
        result = of_keypoints if found is None else replace(
            of_keypoints, T_cam_target=found.T_cam_target, covariance=found.covariance,
            calibration_moves=found.calibration_moves,
        )  # fmt: skip
        if of_keypoints.T_cam_target is None or self.checked_by == "nothing":
            return keypoints, result, None
        edges, aligned = (0.0, None) if found is None else (found.edge_share, found.T_cam_target)
        scores = keypoints.lower_quartile_score
        posed = of_keypoints.T_cam_target
        white = saturated_share(grey, camera, aligned or posed, self.points_target_m)
        return keypoints, result, Evidence.of(scores, of_keypoints.p_value, posed, aligned, edges, white)

    def compared(
        self, image: Image, camera: Camera, result: PoseResult, evidence: Evidence, sky: Sky
    ) -> tuple[PoseResult, Evidence]:
        """Pose and evidence after the view that the pose predicts was laid onto the picture, under a Sun that is told.

        As they were where no shape is known or the picture does not show it.
        """
        if self.shape is None or result.T_cam_target is None or result.covariance is None:
            return result, evidence
        from proxnav.verification import verifier_of  # brings the ray caster, which only this needs

        shared = result.calibration_moves @ result.calibration_moves.T  # errors of the camera stay what they are
        verifier, own = verifier_of(self.shape), result.covariance - shared
        found = verifier.checked(as_grey(image, camera), camera, result.T_cam_target, own, sky)
        if found is None:
            return result, evidence
        if verdict_of(found.similarity, self.trust) != "not_verifiable":
            result = replace(result, T_cam_target=found.T_cam_target, covariance=found.covariance + shared)
        return result, evidence.seen(found.similarity)

    def alignment_of(self, image: Image, camera: Camera) -> Alignment | None:
        """How the pose of an image was laid onto it; None where there is no pose or it stayed that of the keypoints."""
        grey = as_grey(image, camera)
        return self._better_look(grey, camera, *self._from_keypoints(grey, camera, None))[2]

    def solve(self, keypoints: Keypoints, camera: Camera) -> PoseResult:
        """Pose from keypoints that were detected before."""
        if keypoints.status != "ok":
            return PoseResult.failure(keypoints.status, len(self.points_target_m))
        result = estimate_pose(
            self.points_target_m, keypoints.pixels, camera, keypoints.covariances_px2, keypoints.scores, self.pose
        )
        return PoseResult.failure("no_consensus", len(result.inliers)) if _is_vague(result) else result

    def _from_keypoints(self, grey: GreyImage, camera: Camera, box: Box | None) -> tuple[Keypoints, PoseResult]:
        """Keypoints and their pose from the box, or from a search; `no_target` where the keypoints are unsure."""
        if box is not None and self.detect_in is not None:
            keypoints = self.detect_in(grey, box)
            result = self.solve(keypoints, camera)
        else:
            keypoints, result = self._searched(grey, camera)
        if result.T_cam_target is not None and keypoints.median_score < self.least_median_score:
            result = PoseResult.failure("no_target", len(self.points_target_m))
        return keypoints, result

    def _searched(self, grey: GreyImage, camera: Camera) -> tuple[Keypoints, PoseResult]:
        """Keypoints of the whole frame and, where they give a pose, those of a crop round that pose."""
        keypoints = self.detect(grey)
        result = self.solve(keypoints, camera)
        if self.detect_in is None or result.T_cam_target is None:
            return keypoints, result
        box = box_in_image(camera.project(result.T_cam_target @ self.points_target_m), camera)
        if box is None:
            return keypoints, result
        finer = self.detect_in(grey, box)
        finer_result = self.solve(finer, camera)
        return (keypoints, result) if finer_result.T_cam_target is None else (finer, finer_result)

    def _better_look(
        self, grey: GreyImage, camera: Camera, keypoints: Keypoints, result: PoseResult
    ) -> tuple[Keypoints, PoseResult, Alignment | None]:
        """Keypoints, their pose and its alignment: of the upright crop, unless a turned one is clearly better."""
        found = self._aligned(grey, camera, keypoints, result)
        if keypoints.upright is None or found is None:
            return keypoints, result, found
        upright = self.solve(keypoints.upright, camera)
        other = self._aligned(grey, camera, keypoints.upright, upright)
        if other is None or other.score + CLEARLY <= found.score:
            return keypoints, result, found
        return keypoints.upright, upright, other

    def _aligned(self, grey: GreyImage, camera: Camera, keypoints: Keypoints, result: PoseResult) -> Alignment | None:
        """The keypoint pose laid onto the image."""
        if self.shape is None or result.T_cam_target is None or result.covariance is None:
            return None
        prior = Prior.of_result(result, 1.0 - keypoints.median_score)
        return align(grey, camera, self.shape, prior, self.alignment)


def consensus_for(n_keypoints: int) -> PoseConfig:
    """How many keypoints must agree: of many, a handful always does by chance, whatever the image shows."""
    return PoseConfig(min_inliers=max(4, n_keypoints // 3), min_inlier_share=0.6)


def trust_of(model: Model) -> TrustConfig:
    """When poses of a model are to be believed."""
    ranges = None if model.mission is None else model.mission.view.range_m
    return TrustConfig(range_m=ranges, calibration=model.card.trust)


def _assembled(model: Model) -> PoseEstimator:
    card = model.card
    return PoseEstimator(
        model.detect,
        card.keypoints_m,
        card.keypoint_names,
        card.target,
        consensus_for(len(card.keypoints_m)),
        model.detect_in,
        card.least_median_score,
        model.shape,
        card.alignment or AlignConfig(),
        trust_of(model),
    )


def _is_vague(result: PoseResult) -> bool:
    """Whether a pose claims to know so little that it says nothing: keypoints of an image without the target."""
    if result.T_cam_target is None or result.covariance is None:
        return False
    sigma = np.sqrt(np.diag(result.covariance))
    return bool(sigma[3:].max() > VAGUE_RAD or sigma[:3].max() > VAGUE_SHARE * np.linalg.norm(result.T_cam_target.t_m))
