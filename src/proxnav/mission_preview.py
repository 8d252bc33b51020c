"""A contact sheet of a mission: some of its frames, ray-cast."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from proxnav.errors import InputError
from proxnav.frames import FrameJob
from proxnav.geometry.types import Image
from proxnav.images.codecs import encode_png
from proxnav.records import SceneSpec
from proxnav.rendering.config import FrameConfig
from proxnav.storage.files import write_atomic
from proxnav.targets import Target
from proxnav.viewing.overlay import caption, contact_sheet, overlay

COLUMNS = 4
_SIDE_PX = 320


def write_sheet(path: Path, scenes: Sequence[SceneSpec], target: Target, done: Callable[[], None]) -> None:
    """Writes the scenes' frames as one PNG, each with its keypoints, range and phase; `done` is called after each."""
    if path.suffix.lower() != ".png":
        raise InputError(f"--out {path}: the sheet is a picture; name it .png")
    make, tiles = FrameJob(target, FrameConfig("raycast"))(), []
    for scene in scenes:
        small = _small(scene)
        labelled = overlay(make(small).image, small.camera, None, small.T_cam_target, target.keypoints_m)
        tiles.append(caption(contact_sheet([_square(labelled)], 1, _SIDE_PX), _lines(scene)))
        done()
    write_atomic(path, encode_png(contact_sheet(tiles, min(COLUMNS, len(tiles)), _SIDE_PX)))


def _small(scene: SceneSpec) -> SceneSpec:
    scale = 2 * _SIDE_PX / max(scene.camera.width, scene.camera.height)
    small = scene.camera.resized(round(scene.camera.width * scale), round(scene.camera.height * scale))
    return replace(scene, camera=small)


def _square(image: Image) -> Image:
    """The image with grey bars that make it square."""
    height, width = image.shape[:2]
    rows, columns = max(0, width - height), max(0, height - width)
    bars = ((rows // 2, rows - rows // 2), (columns // 2, columns - columns // 2)) + ((0, 0),) * (image.ndim - 2)
    return np.pad(image, bars, constant_values=int(0.25 * np.iinfo(image.dtype).max))


def _lines(scene: SceneSpec) -> list[str]:
    range_m = sum(x * x for x in scene.t_cam_target_m) ** 0.5
    light = f"phase {57.29578 * scene.phase_rad:.0f} deg" if scene.sun.visible_fraction else "in shadow"
    return [f"{range_m:.1f} m, {light}"]
