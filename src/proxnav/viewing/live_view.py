"""A view that people can watch while a stream runs: Rerun serves it, its memory is bounded."""

from typing import Any

import numpy as np

from proxnav.geometry import Camera, Pose
from proxnav.geometry.types import Image
from proxnav.images.codecs import encode_jpeg
from proxnav.images.tones import as_8_bit
from proxnav.records import NavState
from proxnav.targets import Target
from proxnav.viewing.outline_overlay import outline_overlay
from proxnav.viewing.replay.rerun_recording import JPEG_QUALITY, TIMELINE, rerun_module

_MEMORY = "256MB"
"""Most that the server keeps for viewers that come later."""


class LiveView:
    """Serves image, outline, range and status; `url` opens in a viewer: `rerun URL`."""

    def __init__(self, camera: Camera, target: Target | None, port: int) -> None:
        rr = rerun_module()
        self._camera, self._target = camera, target
        self._recording: Any = rr.RecordingStream("proxnav live")
        self.url: str = self._recording.serve_grpc(grpc_port=port, server_memory_limit=_MEMORY)

    def show(self, t: float, image: Image, status: str, T_cam_target: Pose | None, state: NavState | None) -> None:
        """One image with what was found in it."""
        rr, recording = rerun_module(), self._recording
        recording.set_time(TIMELINE, duration=t)
        drawn = as_8_bit(image)
        if T_cam_target is not None and self._target is not None:
            drawn = outline_overlay(image, self._camera, self._target, T_cam_target)
        contents = encode_jpeg(drawn, JPEG_QUALITY)
        recording.log("image", rr.EncodedImage(contents=contents, media_type="image/jpeg"))
        recording.log("status", rr.TextLog(status, level="INFO" if T_cam_target is not None else "WARN"))
        if T_cam_target is not None:
            recording.log("range_m", rr.Scalars(float(np.linalg.norm(T_cam_target.t_m))))
        if state is not None:
            recording.log("navigation/range_m", rr.Scalars(float(np.linalg.norm(state.t_cam_target_m))))

    def close(self) -> None:
        """Stops serving."""
        self._recording.disconnect()
