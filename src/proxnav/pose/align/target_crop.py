"""The part of an image round the target, resampled, with its camera and its gradients."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float, Float32, UInt8

from proxnav.geometry import Camera, Pose
from proxnav.geometry.boxes import box_in_image
from proxnav.geometry.compiled.lens import lens_numbers
from proxnav.geometry.types import Box
from proxnav.images.crop import Crop, cut
from proxnav.targets import Target


@dataclass(frozen=True, slots=True, eq=False)
class TargetCrop:
    """A square of the image."""

    counts: Float32[np.ndarray, "side side"]
    camera: Camera
    """Camera whose image the square is."""
    noise: float
    """Standard deviation of neighbouring pixels [counts], from their median difference."""

    @staticmethod
    def around(
        grey: UInt8[np.ndarray, "height width"], box_xyxy: Box, camera: Camera, margin: float, most: int
    ) -> "TargetCrop":
        """The square about a box [px] of a grey image, `most` px or, when it is smaller, its own size."""
        crop = Crop.around(box_xyxy, margin)
        side = min(most, crop.size)
        counts = cut(grey, crop, side).astype(np.float32)
        noise = float(np.median(np.abs(np.diff(counts, axis=1)))) / (0.6745 * np.sqrt(2.0)) + 0.05
        return TargetCrop(counts, camera.cropped(crop.x, crop.y, crop.size, crop.size).resized(side, side), noise)

    @property
    def lens(self) -> Float[np.ndarray, "lens=18"]:
        """The camera as the kernels take it."""
        return lens_numbers(self.camera)

    def gradients(self, blur_px: float) -> tuple[Float32[np.ndarray, "side side"], Float32[np.ndarray, "side side"]]:
        """(d/dx, d/dy) [counts/px] of the counts blurred by a Gaussian; 0 blurs no further."""
        smooth = cv2.GaussianBlur(self.counts, (0, 0), blur_px) if blur_px > 0.0 else self.counts
        return tuple(cv2.Scharr(smooth, cv2.CV_32F, dx, 1 - dx, scale=1.0 / 32.0) for dx in (1, 0))  # pyright: ignore

    def grid(self, side: int) -> tuple[Float32[np.ndarray, "small small"], Camera]:
        """The counts averaged to (side, side) at most, and the camera of that."""
        side = min(side, len(self.counts))
        small = cv2.resize(self.counts, (side, side), interpolation=cv2.INTER_AREA)
        return small, self.camera.resized(side, side)


def target_box(target: Target, T_cam_target: Pose, camera: Camera) -> Box | None:
    """Box [px] of the target's vertices, cut at the image's edges; None when none of it is in the image."""
    return box_in_image(camera.project(T_cam_target @ target.vertices_m), camera)
