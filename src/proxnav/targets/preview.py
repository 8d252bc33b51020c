"""A contact sheet of a target: views from eight sides with keypoints, names and a metre rule."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float, UInt8

from proxnav.geometry.arrays import unit
from proxnav.targets.target import Target
from proxnav.targets.visibility import first_faces, occluded

Image = UInt8[np.ndarray, "h w 3"]
VIEWS = (
    ("front right, above", 40.0, 25.0), ("rear right, above", 140.0, 25.0),
    ("front left, below", -40.0, -25.0), ("rear left, below", -140.0, -25.0),
    ("front", 0.0, 0.0), ("right", 90.0, 0.0), ("top", 0.0, 90.0), ("belly", 0.0, -90.0),
)  # fmt: skip
"""Name, azimuth from forward towards the right and elevation above the horizon [deg] of the viewer."""
_BACKGROUND, _INK = (38, 34, 30), (235, 235, 235)
_SEEN, _HIDDEN = (80, 220, 255), (110, 110, 110)
_FONT = cv2.FONT_HERSHEY_SIMPLEX


@dataclass(frozen=True, slots=True, eq=False)
class _View:
    """An orthographic camera: p_view = axes @ p_target; x right, y down, z away from the viewer."""

    axes: Float[np.ndarray, "3 3"]
    centre_m: Float[np.ndarray, "3"]
    px_per_m: float
    size: int

    def pixels(self, points_m: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 2"]:
        """Corner-origin pixels of points in the target frame."""
        return (points_m - self.centre_m) @ self.axes[:2].T * self.px_per_m + self.size / 2


def contact_sheet(target: Target, size_px: int = 480, columns: int = 4) -> Image:
    """All views as one BGR picture; keypoints that the view sees are bright and named, the others grey dots."""
    tiles = [_tile(target, name, azimuth, elevation, size_px) for name, azimuth, elevation in VIEWS]
    rows = [np.hstack(tiles[i : i + columns]) for i in range(0, len(tiles), columns)]
    return np.vstack([_title(target, rows[0].shape[1]), *rows])


def _view(target: Target, azimuth_deg: float, elevation_deg: float, size: int) -> _View:
    a, e = np.radians(azimuth_deg), np.radians(elevation_deg)
    away = -np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), -np.sin(e)])
    down = np.array([-1.0, 0.0, 0.0]) if abs(elevation_deg) > 85 else np.array([0.0, 0.0, 1.0])
    right = unit(np.cross(down, away))
    low, high = target.vertices_m.min(axis=0), target.vertices_m.max(axis=0)
    reach = float(np.linalg.norm(target.vertices_m - (low + high) / 2, axis=1).max())
    return _View(np.stack([right, np.cross(away, right), away]), (low + high) / 2, 0.47 * size / reach, size)


def _tile(target: Target, name: str, azimuth_deg: float, elevation_deg: float, size: int) -> Image:
    view = _view(target, azimuth_deg, elevation_deg, size)
    image = np.ascontiguousarray(_shaded(target, view))
    _draw_keypoints(image, target, view)
    _draw_rule(image, view)
    cv2.putText(image, name, (10, 20), _FONT, 0.5, _INK, 1, cv2.LINE_AA)
    cv2.rectangle(image, (0, 0), (size - 1, size - 1), (70, 66, 60), 1)
    return image


def _shaded(target: Target, view: _View) -> Image:
    """Nominal albedos under a lamp above the viewer's left shoulder and a weak fill; four rays a pixel."""
    n = view.size * 2
    grid = (np.arange(n) + 0.5) / 2
    x, y = np.meshgrid(grid - view.size / 2, grid - view.size / 2)
    flat = np.stack([x.ravel(), y.ravel()], axis=1) / view.px_per_m
    start = view.centre_m - 4 * target.radius_m * view.axes[2] + flat @ view.axes[:2]
    _, face = first_faces(target, start, np.broadcast_to(view.axes[2], start.shape))
    hit = face >= 0
    normal = unit(target.corner_normals.mean(axis=1)[face[hit]] + 1e-12)
    lamp = unit(np.array([-0.5, -0.7, -1.0]) @ view.axes)
    shade = 0.25 + 0.75 * np.clip(normal @ lamp, 0.0, 1.0)
    albedo = np.array([m.albedo for m in target.materials])[target.face_part[face[hit]]]
    linear = np.tile((np.array(_BACKGROUND[::-1]) / 255.0) ** 2.2, (n * n, 1))
    linear[hit] = np.clip(albedo * shade[:, None], 0.0, 1.0)
    mean = linear.reshape(view.size, 2, view.size, 2, 3).mean(axis=(1, 3))
    return (255 * mean ** (1 / 2.2)).astype(np.uint8)[..., ::-1]


def _draw_keypoints(image: Image, target: Target, view: _View) -> None:
    """Dots and names; names are pushed down until they do not cover one another."""
    if not len(target.keypoints_m):
        return
    eyes = target.keypoints_m - 8 * target.radius_m * view.axes[2]
    hidden = occluded(target, target.keypoints_m, eyes, 0.01 * target.radius_m)
    taken: list[tuple[int, int, int]] = []
    for k in np.argsort(hidden, kind="stable"):
        x, y = (round(v) for v in view.pixels(target.keypoints_m[k : k + 1])[0].tolist())
        cv2.circle(image, (x, y), 3, _HIDDEN if hidden[k] else _SEEN, 1 if hidden[k] else -1, cv2.LINE_AA)
        if not hidden[k]:
            _label(image, target.keypoint_names[k], x, y, taken)


def _label(image: Image, name: str, x: int, y: int, taken: list[tuple[int, int, int]]) -> None:
    (width, height), _ = cv2.getTextSize(name, _FONT, 0.33, 1)
    left = x + 6 if x + 6 + width < image.shape[1] else x - 6 - width
    low = y - 4
    while any(abs(low - other) < height + 3 and left < b and a < left + width for a, b, other in taken):
        low += 3
    taken.append((left, left + width, low))
    cv2.putText(image, name, (left, low), _FONT, 0.33, _SEEN, 1, cv2.LINE_AA)


def _draw_rule(image: Image, view: _View) -> None:
    """A bar of 1, 2 or 5 times a power of ten metres, about a fifth of the picture."""
    room = 0.25 * view.size / view.px_per_m
    decade = 10.0 ** np.floor(np.log10(room))
    length = max(f * decade for f in (1, 2, 5) if f * decade <= room)
    end, y = 10 + round(length * view.px_per_m), view.size - 14
    cv2.line(image, (10, y), (end, y), _INK, 1)
    for x in (10, end):
        cv2.line(image, (x, y - 4), (x, y + 4), _INK, 1)
    cv2.putText(image, f"{length:g} m", (end + 6, y + 4), _FONT, 0.42, _INK, 1, cv2.LINE_AA)


def _title(target: Target, width: int) -> Image:
    size = " x ".join(f"{v:.2f}" for v in np.ptp(target.vertices_m, axis=0))
    text = f"{target.name}: {size} m (forward, right, down), {len(target.faces)} triangles, "
    text += f"{len(target.part_names)} parts, {len(target.keypoint_names)} keypoints"
    bar = np.full((36, width, 3), _BACKGROUND, np.uint8)
    cv2.putText(bar, text, (10, 24), _FONT, 0.55, _INK, 1, cv2.LINE_AA)
    return bar
