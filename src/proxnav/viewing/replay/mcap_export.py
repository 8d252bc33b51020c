"""A replay as MCAP with ROS 2 messages: `ros2 bag play FILE`, or open it in Foxglove.

/camera/image/compressed   sensor_msgs/CompressedImage      /target/pose/estimate   PoseWithCovarianceStamped, in camera
/camera/camera_info        sensor_msgs/CameraInfo           /target/pose/truth      PoseStamped, in camera
/camera/annotations        foxglove_msgs/ImageAnnotations   /tf                     camera, target, estimate in world
"""

from pathlib import Path
from typing import Any

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.geometry.epochs import parse_iso
from proxnav.geometry.types import Pixels
from proxnav.images.codecs import encode_jpeg, read_image
from proxnav.images.tones import as_8_bit
from proxnav.storage.files import replacing
from proxnav.viewing.replay.replay import Replay, ReplayStep
from proxnav.viewing.replay.rerun_recording import JPEG_QUALITY, ellipses
from proxnav.viewing.replay.ros2_messages import LAYOUTS, LINE_LOOP

_FOUND, _TRUE = (1.0, 0.78, 0.16, 1.0), (0.35, 0.86, 0.35, 1.0)
_CLEAR = {"r": 0.0, "g": 0.0, "b": 0.0, "a": 0.0}
TYPES = {
    "/camera/image/compressed": "sensor_msgs/msg/CompressedImage",
    "/camera/camera_info": "sensor_msgs/msg/CameraInfo",
    "/camera/annotations": "foxglove_msgs/msg/ImageAnnotations",
    "/target/pose/estimate": "geometry_msgs/msg/PoseWithCovarianceStamped",
    "/target/pose/navigation": "geometry_msgs/msg/PoseWithCovarianceStamped",
    "/target/pose/truth": "geometry_msgs/msg/PoseStamped",
    "/tf": "tf2_msgs/msg/TFMessage",
}
"""Message type of each topic."""
START_WITHOUT_EPOCH_NS = 1_000_000_000
"""Frames that are no sequence in time start one second after 1970: ROS takes time zero as 'no time'."""


def save_mcap(replay: Replay, path: Path) -> None:
    """Writes the file; whole or not at all."""
    Writer = writer_class()
    start = start_ns(replay)
    with replacing(path) as part, part.open("wb") as file:
        writer = Writer(file)
        schemas = {name: writer.register_msgdef(name, LAYOUTS[name]) for name in LAYOUTS}
        for number, step in enumerate(replay.steps):
            stamp = start + round(step.t * 1e9)
            for topic, message in messages(replay, step, stamp).items():
                writer.write_message(topic, schemas[TYPES[topic]], message, stamp, stamp, number)
        writer.finish()


def start_ns(replay: Replay) -> int:
    """Nanoseconds since 1970 (UTC) of t = 0."""
    if not replay.is_sequence:
        return START_WITHOUT_EPOCH_NS
    return round((parse_iso(replay.epoch_utc) - parse_iso("1970-01-01T00:00:00Z")) * 1e6) * 1000


def messages(replay: Replay, step: ReplayStep, stamp_ns: int) -> dict[str, dict[str, Any]]:
    """What is said at one step, by topic."""
    header = {"stamp": ros_time(stamp_ns), "frame_id": "camera"}
    said: dict[str, dict[str, Any]] = {"/camera/camera_info": {"header": header} | camera_info(replay.camera)}
    if step.image is not None and step.image.is_file():
        data = encode_jpeg(as_8_bit(read_image(step.image)), JPEG_QUALITY)
        said["/camera/image/compressed"] = {"header": header, "format": "jpeg", "data": data}
    said["/camera/annotations"] = _annotations(replay, step, header["stamp"])
    if step.estimate is not None:
        covariance = np.zeros((6, 6)) if step.pose_covariance is None else step.pose_covariance
        pose = {"pose": ros_pose(step.estimate.T_cam_target), "covariance": covariance.ravel().tolist()}
        said["/target/pose/estimate"] = {"header": header, "pose": pose}
    if step.truth is not None:
        said["/target/pose/truth"] = {"header": header, "pose": ros_pose(step.truth.T_cam_target)}
    said["/tf"] = {"transforms": _transforms(step, header["stamp"])}
    return said


def ros_model(camera: Camera) -> str:
    """Name that ROS has for the camera's lens."""
    if camera.projection == "fisheye":
        return "equidistant"
    return "plumb_bob" if len(camera.distortion) == 5 else "rational_polynomial"


def camera_info(camera: Camera) -> dict[str, Any]:
    """Fields of sensor_msgs/CameraInfo; ROS puts pixel (0, 0) at the centre of the first pixel."""
    K, d = camera.to_opencv()
    roi = {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False}
    return {
        "height": camera.height, "width": camera.width, "distortion_model": ros_model(camera), "d": d.tolist(),
        "k": K.ravel().tolist(), "r": np.eye(3).ravel().tolist(), "p": np.c_[K, np.zeros(3)].ravel().tolist(),
        "binning_x": 0, "binning_y": 0, "roi": roi,
    }  # fmt: skip


def _annotations(replay: Replay, step: ReplayStep, stamp: dict[str, int]) -> dict[str, Any]:
    """Corner-origin pixels, as Foxglove's annotations have them."""
    shown = step.truth
    true = np.zeros((0, 2)) if shown is None else replay.camera.project(shown.T_cam_target @ replay.keypoints_m)
    found = np.zeros((0, 2)) if step.pixels is None else step.pixels
    circles = [_circle(p, 4.0, _FOUND, stamp) for p in found if np.isfinite(p).all()]
    circles += [_circle(p, 6.0, _TRUE, stamp) for p in true if replay.camera.contains(p)]
    loops = [
        {"timestamp": stamp, "type": LINE_LOOP, "points": [_xy(p) for p in line[:-1]], "outline_color": _rgba(_FOUND),
         "outline_colors": [], "fill_color": _CLEAR, "thickness": 1.0}
        for line in ellipses(step)
    ]  # fmt: skip
    text = {"timestamp": stamp, "position": {"x": 8.0, "y": 24.0}, "text": f"{step.label}: {step.status}",
            "font_size": 18.0, "text_color": _rgba((1.0, 1.0, 1.0, 1.0)), "background_color": _CLEAR}  # fmt: skip
    return {"circles": circles, "points": loops, "texts": [text]}


def _transforms(step: ReplayStep, stamp: dict[str, int]) -> list[dict[str, Any]]:
    best = step.truth or step.estimate
    frames: list[tuple[str, Pose]] = []
    if best is not None:
        frames += [("camera", best.T_world_cam), ("target", best.T_world_target)]
    if step.estimate is not None:
        frames.append(("camera_estimate", step.estimate.T_world_cam))
    return [ros_transform("world", name, T, stamp) for name, T in frames]


def ros_transform(parent: str, child: str, T: Pose, stamp: dict[str, int]) -> dict[str, Any]:
    """Fields of geometry_msgs/TransformStamped: T maps the child's coordinates to the parent's."""
    transform = {"translation": _xyz(T), "rotation": _rotation(T)}
    return {"header": {"stamp": stamp, "frame_id": parent}, "child_frame_id": child, "transform": transform}


def ros_pose(T: Pose) -> dict[str, Any]:
    """Fields of geometry_msgs/Pose."""
    return {"position": _xyz(T), "orientation": _rotation(T)}


def _xyz(T: Pose) -> dict[str, float]:
    return dict(zip("xyz", T.t_m.tolist(), strict=True))


def _rotation(T: Pose) -> dict[str, float]:
    return dict(zip("wxyz", T.q_wxyz.tolist(), strict=True))


def _circle(pixel: Pixels, diameter: float, colour: tuple[float, ...], stamp: dict[str, int]) -> dict[str, Any]:
    return {"timestamp": stamp, "position": _xy(pixel), "diameter": diameter, "thickness": 1.0,
            "fill_color": _CLEAR, "outline_color": _rgba(colour)}  # fmt: skip


def _xy(pixel: Pixels) -> dict[str, float]:
    return {"x": float(pixel[0]), "y": float(pixel[1])}


def _rgba(colour: tuple[float, ...]) -> dict[str, float]:
    return dict(zip("rgba", colour, strict=True))


def ros_time(stamp_ns: int) -> dict[str, int]:
    """Fields of builtin_interfaces/Time of nanoseconds since 1970."""
    return {"sec": stamp_ns // 10**9, "nanosec": stamp_ns % 10**9}


def writer_class() -> Any:
    """The writer of MCAP files with ROS 2 messages. InputError where it is not installed."""
    try:
        from mcap_ros2.writer import Writer
    except ImportError:
        raise InputError("MCAP files need mcap-ros2-support: pip install 'proxnav[view]'") from None
    return Writer
