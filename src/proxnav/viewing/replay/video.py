"""A replay as a video: each step's image with what was found, what is true and what is estimated."""

from fractions import Fraction
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.geometry.types import GreyImage
from proxnav.images.codecs import read_image
from proxnav.records import Keypoints
from proxnav.storage.files import replacing
from proxnav.targets import Target
from proxnav.viewing.overlay import Canvas, caption, overlay
from proxnav.viewing.replay.replay import Replay, ReplayStep


def save_video(replay: Replay, path: Path, frames_per_s: float = 10.0, side: int = 1024) -> None:
    """Writes an mp4 (H.264, plays in browsers), one frame a step, its longer side at most `side` px."""
    if not 0.1 <= frames_per_s <= 120.0 or not 64 <= side <= 4096:
        raise InputError(
            f"a video needs 0.1 to 120 frames per second and 64 to 4096 px, found {frames_per_s} and {side}"
        )
    av = _av()
    width, height = _even_size(replay, side)
    settings = {"mode": "w", "format": "mp4", "options": {"movflags": "faststart"}}
    with replacing(path) as part, av.open(str(part), **settings) as container:
        stream = container.add_stream("libx264", rate=Fraction(round(frames_per_s * 1000), 1000))
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        stream.options = {"crf": "23", "preset": "veryfast"}
        for step in replay.steps:
            picture = cv2.resize(draw_step(replay, step), (width, height), interpolation=cv2.INTER_AREA)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        container.mux(stream.encode())


def draw_step(replay: Replay, step: ReplayStep) -> Canvas:
    """RGB picture of one step; over a sketch of the target where the run has no image."""
    camera, shown = replay.camera, step.truth or step.estimate
    if step.image is not None and step.image.is_file():
        image = read_image(step.image)
    elif replay.target is not None and shown is not None:
        image = sketch(replay.target, camera, shown.T_cam_target)
    else:
        image = np.zeros((camera.height, camera.width), np.uint8)
    T_true = None if step.truth is None else step.truth.T_cam_target
    T_est = None if step.estimate is None else step.estimate.T_cam_target
    canvas = overlay(image, camera, T_est, T_true, replay.keypoints_m, _found(step))
    return caption(canvas, _lines(replay, step))


def sketch(target: Target, camera: Camera, T_cam_target: Pose) -> GreyImage:
    """The mesh in flat grey, lit from the camera, far triangles first. No render: only to see it."""
    image = np.zeros((camera.height, camera.width), np.uint8)
    corners = (T_cam_target @ target.vertices_m)[target.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middle = corners.mean(axis=1)
    lengths = np.linalg.norm(normals, axis=1) * np.linalg.norm(middle, axis=1)
    facing = -np.einsum("ni,ni->n", normals, middle) / np.maximum(lengths, 1e-12)
    pixels = np.round(camera.project(corners) - 0.5)
    shown = (facing > 0.0) & (corners[..., 2].min(axis=1) > 0.0) & (np.abs(pixels) < 1e5).all(axis=(1, 2))
    for k in np.flatnonzero(shown)[np.argsort(-middle[shown, 2])]:
        cv2.fillConvexPoly(image, pixels[k].astype(np.int32), round(30 + 60 * float(facing[k])))
    return image


def _found(step: ReplayStep) -> Keypoints | None:
    if step.pixels is None or step.covariances_px2 is None:
        return None
    n = len(step.pixels)
    return Keypoints("ok", step.pixels, step.covariances_px2, np.ones(n), np.full(4, np.nan))


def _lines(replay: Replay, step: ReplayStep) -> list[str]:
    when = f"t = {step.t:.1f} s  " if replay.is_sequence and not step.label.startswith("t =") else ""
    shown = step.truth or step.estimate
    range_text = "" if shown is None else f"  range {np.linalg.norm(shown.T_cam_target.t_m):.1f} m"
    if step.errors is None:
        return [f"{when}{step.label}{range_text}", step.status]
    position, turn = np.linalg.norm(step.errors[:3]), np.degrees(np.linalg.norm(step.errors[3:]))
    return [f"{when}{step.label}{range_text}", f"{step.status}: E_T {position:.2f} m, E_R {turn:.2f} deg"]


def _even_size(replay: Replay, side: int) -> tuple[int, int]:
    """H.264 with 4:2:0 colour wants even sides."""
    camera = replay.camera
    scale = min(1.0, side / max(camera.width, camera.height))
    return max(2, 2 * round(camera.width * scale / 2)), max(2, 2 * round(camera.height * scale / 2))


def _av() -> Any:
    try:
        import av
    except ImportError:
        raise InputError("videos need PyAV: pip install 'proxnav[view]'") from None
    return av
