"""Pictures of what was found in images whose truth nobody knows."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.images.codecs import encode_png, read_image
from proxnav.records import Keypoints
from proxnav.storage.files import write_atomic
from proxnav.viewing.overlay import caption, overlay

_AXIS_SHARE = 0.1
"""Length of the drawn axes over the range."""


def write_found_overlays(
    folder: Path, images: Sequence[Path], camera: Camera, records: Sequence[PoseRecord], keypoints: Sequence[Keypoints]
) -> None:
    """NAME.png for each readable image: keypoints with their ellipses, axes of the target, range or the status."""
    for path, record, found in zip(images, records, keypoints, strict=True):
        try:
            image = read_image(path)
        except InputError:
            continue
        T = record.T_cam_target
        range_m = 0.0 if T is None else float(np.linalg.norm(T.t_m))
        canvas = overlay(image, camera, T, None, None, found, max(_AXIS_SHARE * range_m, 1e-3))
        said = record.status if T is None else f"range {range_m:.2f} m, {_deviations(record)}"
        write_atomic(folder / f"{path.stem}.png", encode_png(caption(canvas, [path.name, said])))


def _deviations(record: PoseRecord) -> str:
    if record.covariance is None:
        return "no covariance"
    sigma = np.sqrt(np.diagonal(record.covariance))
    return f"1 sigma {np.linalg.norm(sigma[:3]):.3g} m, {np.degrees(np.linalg.norm(sigma[3:])):.2g} deg"
