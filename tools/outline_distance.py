"""How far a target's outline at the true poses lies from the edges of photographs, image by image.

    python tools/outline_distance.py LABELS.json IMAGES [MORE_IMAGES ...] --camera camera.json [--target tango]

Each point of the projected mesh's outer contour looks along its normal for the nearest strong edge, up to 15 px away; a
point that sees none is not counted, so black faces before black sky say nothing. Distances are medians, also scaled to
6 m. A shift of the whole image, which an error of the label looks like, is fitted and taken away in the last column.
"""

import argparse
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Float
from scipy.ndimage import map_coordinates

from proxnav.datasets.formats.speed_poses import read_poses
from proxnav.geometry import Camera, Pose
from proxnav.images.codecs import read_image
from proxnav.images.tones import grey_8_bit
from proxnav.targets.loading import load_target
from proxnav.targets.target import Target

REACH_PX, STEP_PX, LEAST_SLOPE = 15, 0.5, 5.0
REFERENCE_M = 6.0
_SUBPIXEL = 2  # bits of fillConvexPoly
_CHORD = 5  # contour points to either side that make the tangent
_BORDER_PX = 20

Offsets = Float[np.ndarray, "n"]
Vectors = Float[np.ndarray, "n 2"]


def main() -> None:
    """Prints a row for each image and the median of all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("labels", type=Path)
    parser.add_argument("images", type=Path, nargs="+")
    parser.add_argument("--camera", type=Path, required=True)
    parser.add_argument("--target", default="tango")
    options = parser.parse_args()
    camera, target = Camera.read(options.camera), load_target(options.target)
    print("image              range [m]  contour with an edge  median [px]  at 6 m [px]  without shift, at 6 m [px]")
    rows = []
    for name, record in read_poses(options.labels).items():
        path = next((folder / name for folder in options.images if (folder / name).is_file()), None)
        if path is not None and record.T_cam_target is not None:
            rows.append(_measure(grey_8_bit(read_image(path)), record.T_cam_target, camera, target))
            print(_line(name, rows[-1]))
    if not rows:
        raise SystemExit(f"{options.labels}: names no image of {', '.join(map(str, options.images))}")
    print(_line("median", np.median(rows, axis=0)))


def _line(name: str, row: Float[np.ndarray, "5"]) -> str:
    range_m, share, distance, scaled, shifted = row
    return f"{name:18s} {range_m:9.2f}  {100 * share:18.0f} %  {distance:11.1f}  {scaled:11.1f}  {shifted:26.1f}"


def _measure(grey: np.ndarray, T_cam_target: Pose, camera: Camera, target: Target) -> Float[np.ndarray, "5"]:
    points, normals = _contour(T_cam_target, camera, target)
    offsets = _nearest_edges(grey, points, normals)
    seen = np.isfinite(offsets)
    range_m = float(np.linalg.norm(T_cam_target.t_m))
    if seen.sum() < 2:
        return np.array([range_m, 0.0, np.nan, np.nan, np.nan])
    left = offsets[seen] - normals[seen] @ _shift(offsets[seen], normals[seen])
    plain, shifted = np.median(np.abs(offsets[seen])), np.median(np.abs(left))
    scale = range_m / REFERENCE_M
    return np.array([range_m, seen.mean(), plain, plain * scale, shifted * scale])


def _contour(T_cam_target: Pose, camera: Camera, target: Target) -> tuple[Vectors, Vectors]:
    """Points [px, array index] along the mesh's outer contour inside the image, and unit normals there."""
    corners = camera.project(T_cam_target @ target.vertices_m)[target.faces] - 0.5
    mask = np.zeros((camera.height, camera.width), np.uint8)
    for triangle in np.round(corners * 2**_SUBPIXEL).astype(np.int32):
        cv2.fillConvexPoly(mask, triangle, 255, shift=_SUBPIXEL)
    found, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    points = max(found, key=len)[:, 0].astype(np.float64)
    chord = np.roll(points, -_CHORD, axis=0) - np.roll(points, _CHORD, axis=0)
    length = np.linalg.norm(chord, axis=1)
    high = np.array([camera.width, camera.height]) - _BORDER_PX
    keep = (length > 1.6 * _CHORD) & ((points > _BORDER_PX) & (points < high)).all(axis=1)  # no sharp corners
    return points[keep], np.stack([chord[:, 1], -chord[:, 0]], axis=1)[keep] / length[keep, None]


def _nearest_edges(grey: np.ndarray, points: Vectors, normals: Vectors) -> Offsets:
    """Signed way [px] along each normal to the nearest strong edge; NaN where there is none."""
    smooth = cv2.GaussianBlur(grey.astype(np.float64), (0, 0), 1.0)
    along = np.arange(-REACH_PX, REACH_PX + STEP_PX / 2, STEP_PX)
    where = points[:, None] + along[None, :, None] * normals[:, None]
    slope = np.abs(np.gradient(map_coordinates(smooth, [where[..., 1], where[..., 0]], order=1), STEP_PX, axis=1))
    crest = (slope >= np.roll(slope, 1, axis=1)) & (slope >= np.roll(slope, -1, axis=1))
    crest &= slope > np.maximum(LEAST_SLOPE, 0.5 * slope.max(axis=1, keepdims=True))
    crest[:, [0, -1]] = False
    distance = np.where(crest, np.abs(along), np.inf)
    return np.where(crest.any(axis=1), along[distance.argmin(axis=1)], np.nan)


def _shift(offsets: Offsets, normals: Vectors) -> Float[np.ndarray, "2"]:
    """The image shift that explains the offsets best, by least absolute values."""
    shift = np.zeros(2)
    for _ in range(20):
        root = np.sqrt(1.0 / np.maximum(np.abs(offsets - normals @ shift), 1.0))
        shift = np.linalg.lstsq(normals * root[:, None], offsets * root, rcond=None)[0]
    return shift


if __name__ == "__main__":
    main()
