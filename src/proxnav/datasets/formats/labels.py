"""The one form that every format is read into and written from: images with poses, the camera, the target's points."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.geometry.arrays import frozen
from proxnav.geometry.boxes import box_of_points
from proxnav.geometry.types import Box, Points
from proxnav.images.codecs import image_size
from proxnav.records import NOT_IN_IMAGE, VISIBLE, FrameLabel


@dataclass(frozen=True, slots=True, eq=False)
class LabelRecord:
    """What a file says about one image; None is what it does not say."""

    filename: str
    """Name of the image below its split's image folder."""
    T_cam_target: Pose | None
    status: str = "ok"
    """Why there is no pose, of estimates."""
    split: str = ""
    """Part of the set, such as `synthetic/train`, `lightbox/test`, a sequence or a scene; empty in undivided sets."""
    keypoints_px: Float[np.ndarray, "n_keypoints 2"] | None = None
    """Keypoints [px], corner origin; NaN where unknown."""
    visibility: Int[np.ndarray, "n_keypoints"] | None = None
    """COCO's visibility codes."""
    box_xyxy: Box | None = None
    covariance: Float[np.ndarray, "6 6"] | None = None
    """Covariance of the pose, translation first, camera frame."""
    score: float = 1.0
    """Confidence of an estimate, where the format has one."""
    image: Path | None = None
    """The image, where it is on this disk."""
    mask: Path | None = None
    """255 where the target is, where there is one."""
    size_px: tuple[int, int] | None = None
    """(width, height) of the image, where the file says it."""
    t_s: float | None = None
    """Time of a record of a sequence."""

    def __post_init__(self) -> None:
        for name, shape in (("keypoints_px", (None, 2)), ("box_xyxy", (4,)), ("covariance", (6, 6))):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, frozen(getattr(self, name), shape, name))
        if self.visibility is not None:
            object.__setattr__(self, "visibility", frozen(self.visibility, (None,), "visibility", np.int64))


@dataclass(frozen=True, slots=True, eq=False)
class Labels:
    """A data set or a file of poses, whatever format it came from."""

    records: tuple[LabelRecord, ...]
    camera: Camera | None = None
    keypoints_m: Points | None = None
    """Keypoints in the target frame."""
    keypoint_names: tuple[str, ...] = ()
    target_name: str = "target"
    format: str = ""
    """The format it was read from."""

    def __post_init__(self) -> None:
        if self.keypoints_m is not None:
            object.__setattr__(self, "keypoints_m", frozen(self.keypoints_m, (None, 3), "keypoints_m"))
            if not self.keypoint_names:
                names = tuple(f"p{i:02d}" for i in range(len(self.keypoints_m)))
                object.__setattr__(self, "keypoint_names", names)

    def __len__(self) -> int:
        return len(self.records)


def from_frame_label(label: FrameLabel, image: Path | None = None, mask: Path | None = None) -> LabelRecord:
    """The record of a label of ours."""
    box = None if np.isnan(label.box_xyxy).any() else label.box_xyxy
    return LabelRecord(
        label.filename, label.T_cam_target, keypoints_px=label.keypoints_px, visibility=label.visibility,
        box_xyxy=box, image=image, mask=mask,
    )  # fmt: skip


def with_projected_keypoints(labels: Labels) -> Labels:
    """The same labels with pixels for the keypoints wherever a pose and a camera give them and the file does not."""
    if labels.camera is None or labels.keypoints_m is None:
        return labels
    return replace(labels, records=tuple(_projected(record, labels) for record in labels.records))


def size_of(record: LabelRecord, labels: Labels, format: str) -> tuple[int, int]:
    """(width, height) of the record's image [px]: of the camera, the labels or the image file, or InputError."""
    if labels.camera is not None:
        return labels.camera.width, labels.camera.height
    if record.size_px is not None:
        return record.size_px
    if record.image is not None:
        return image_size(record.image)
    raise InputError(
        f"{format} needs the size of '{record.filename}', which neither the labels nor an image beside them tell; "
        "give --camera"
    )


def visibility_of(record: LabelRecord, labels: Labels, format: str) -> Int[np.ndarray, "n_keypoints"]:
    """COCO's codes of the record's keypoints. Where the file says none, points in the image count as visible: nothing
    is known about what the target hides.
    """
    if record.visibility is not None:
        return record.visibility
    pixels = record.keypoints_px
    if pixels is None:
        raise InputError(f"{format} needs keypoints and '{record.filename}' has none; give --target and --camera")
    inside = ((pixels >= 0.0) & (pixels <= size_of(record, labels, format))).all(axis=1)
    return np.where(inside, VISIBLE, NOT_IN_IMAGE)


def need_camera(labels: Labels, format: str) -> Camera:
    """The camera, or InputError that says who needs it."""
    if labels.camera is None:
        raise InputError(f"{format} needs a camera and the source has none; give --camera camera.json")
    return labels.camera


def need_keypoints(labels: Labels, format: str) -> Points:
    """The target's points [m], or InputError that says who needs them."""
    if labels.keypoints_m is None:
        raise InputError(f"{format} needs the target's 3-D points and the source has none; give --target NAME or FILE")
    return labels.keypoints_m


def need_pose(record: LabelRecord, format: str) -> Pose:
    """The record's pose, or InputError where the format cannot say that there is none."""
    if record.T_cam_target is None:
        raise InputError(
            f"'{record.filename}' has no pose (status {record.status}) and {format} cannot say so; "
            "leave such images out with --skip-without-pose"
        )
    return record.T_cam_target


def pixels_of(record: LabelRecord, format: str) -> Float[np.ndarray, "n_keypoints 2"]:
    """Finite pixels of the keypoints, or InputError."""
    if record.keypoints_px is None:
        raise InputError(f"{format} needs keypoints and '{record.filename}' has none; give --target and --camera")
    if not np.isfinite(record.keypoints_px).all():
        raise InputError(
            f"'{record.filename}' has keypoints behind the camera or outside its lens, which {format} cannot hold; "
            "leave the image out"
        )
    return record.keypoints_px


def box_of(record: LabelRecord, format: str) -> Box:
    """The record's box, else the extent of its keypoints."""
    if record.box_xyxy is not None:
        return record.box_xyxy
    return box_of_points(pixels_of(record, format))


def _projected(record: LabelRecord, labels: Labels) -> LabelRecord:
    T, camera = record.T_cam_target, labels.camera
    if record.keypoints_px is not None or T is None or camera is None or labels.keypoints_m is None:
        return record
    return replace(record, keypoints_px=camera.project(T @ labels.keypoints_m))
