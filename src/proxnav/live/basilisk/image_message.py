"""Encoded images in Basilisk's memory: CameraImageMsg holds an address, a length, and nothing of its own."""

import ctypes
from typing import Any

import numpy as np

from proxnav.live.basilisk.installed import messaging, sim_model

_GREY, _COLOUR = 1, 3


class KeptImage:
    """An encoded image whose bytes stay where the message says: Basilisk copies the address only.

    Whoever writes the message keeps this value until the next one is written.
    """

    def __init__(self, encoded: bytes) -> None:
        self._bytes = np.frombuffer(encoded, dtype=np.uint8).copy()

    def payload(self, nanos: int, camera_id: int, channels: int) -> Any:
        """A valid CameraImageMsg payload of the image taken at `nanos`."""
        payload = messaging.CameraImageMsgPayload()
        payload.timeTag, payload.valid, payload.cameraID = nanos, 1, camera_id
        payload.imageType, payload.imageBufferLength = _COLOUR if channels > 1 else _GREY, len(self._bytes)
        _fields(payload)["imagePointer"] = self._bytes.ctypes.data  # plain assignment of an address is refused
        return payload


def image_bytes(payload: Any) -> bytes:
    """The encoded image of a CameraImageMsg payload; empty where the message points nowhere."""
    address, length = int(payload.imagePointer or 0), int(payload.imageBufferLength)
    return ctypes.string_at(address, length) if address and length > 0 else b""


def _fields(payload: Any) -> np.ndarray:
    """The payload's memory, by field."""
    kind = type(payload)
    size = np.dtype(kind.__dtype__).itemsize
    memory: Any = (ctypes.c_char * size).from_address(sim_model.getObjectAddress(payload))
    return np.frombuffer(memory, dtype=kind.__dtype__)
