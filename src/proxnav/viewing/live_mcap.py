"""Poses and images as they come, as MCAP with ROS 2 messages: the topics of a replay, written one by one."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera, Pose
from proxnav.geometry.types import Image
from proxnav.images.codecs import encode_jpeg
from proxnav.images.tones import as_8_bit
from proxnav.records import NavState
from proxnav.storage.files import cannot_write
from proxnav.viewing.replay.mcap_export import (
    START_WITHOUT_EPOCH_NS,
    TYPES,
    camera_info,
    ros_pose,
    ros_time,
    ros_transform,
    writer_class,
)
from proxnav.viewing.replay.rerun_recording import JPEG_QUALITY
from proxnav.viewing.replay.ros2_messages import LAYOUTS


class LiveMcap:
    """An open MCAP file of one camera."""

    def __init__(self, writer: Any, camera: Camera) -> None:
        self._writer, self._camera, self._count = writer, camera, 0
        self._schemas = {name: writer.register_msgdef(name, LAYOUTS[name]) for name in LAYOUTS}

    @staticmethod
    @contextmanager
    def into(path: Path, camera: Camera) -> Iterator["LiveMcap"]:
        """A new file; its index is written at the end, also after an interrupt."""
        Writer = writer_class()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            file = path.open("wb")
        except OSError as error:
            raise cannot_write(path, error) from None
        with file:
            writer = Writer(file)
            try:
                yield LiveMcap(writer, camera)
            finally:
                writer.finish()

    def write(
        self, t: float, image: Image, T_cam_target: Pose | None, covariance: Float[np.ndarray, "6 6"] | None,
        state: NavState | None,
    ) -> None:  # fmt: skip
        """One image taken at t [s], with its pose and the pose that a filter believes, where there are any."""
        stamp = START_WITHOUT_EPOCH_NS + round(t * 1e9)
        header = {"stamp": ros_time(stamp), "frame_id": "camera"}
        data = encode_jpeg(as_8_bit(image), JPEG_QUALITY)
        said: dict[str, Any] = {
            "/camera/camera_info": {"header": header} | camera_info(self._camera),
            "/camera/image/compressed": {"header": header, "format": "jpeg", "data": data},
        }
        if T_cam_target is not None:
            P = np.zeros((6, 6)) if covariance is None else covariance
            pose = {"pose": ros_pose(T_cam_target), "covariance": P.ravel().tolist()}
            said["/target/pose/estimate"] = {"header": header, "pose": pose}
            said["/tf"] = {"transforms": [ros_transform("camera", "target", T_cam_target, header["stamp"])]}
        if state is not None:
            T = Pose("cam", "target", state.q_cam_target, state.t_cam_target_m)
            pose = {"pose": ros_pose(T), "covariance": state.pose_covariance.ravel().tolist()}
            said["/target/pose/navigation"] = {"header": header, "pose": pose}
        for topic, message in said.items():
            self._writer.write_message(topic, self._schemas[TYPES[topic]], message, stamp, stamp, self._count)
        self._count += 1
