"""A contact sheet of a target: views from eight sides with keypoints, names and a metre rule."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Float, Int, UInt8

from proxnav.errors import InputError
from proxnav.geometry.arrays import unit
from proxnav.targets.keypoints.visibility import HIT_TOLERANCE, first_faces, occluded
from proxnav.targets.surface.part_image import linear_texels
from proxnav.targets.target import Target

Image = UInt8[np.ndarray, "h w 3"]
VIEWS = (
    ("from +x +y -z", 40.0, 25.0), ("from -x +y -z", 140.0, 25.0),
    ("from +x -y +z", -40.0, -25.0), ("from -x -y +z", -140.0, -25.0),
    ("from +x", 0.0, 0.0), ("from +y", 90.0, 0.0), ("from -z", 0.0, 90.0), ("from +z", 0.0, -90.0),
)  # fmt: skip
"""Name, azimuth from +x towards +y and elevation towards -z [deg] of the viewer; -z is up, as for a frame of forward,
right, down."""
_BACKGROUND, _INK = (38, 34, 30), (235, 235, 235)
_SEEN, _HIDDEN = (80, 220, 255), (110, 110, 110)
_AXES = (80, 80, 255), (80, 220, 80), (255, 140, 80)
_FONT = cv2.FONT_HERSHEY_SIMPLEX


@dataclass(frozen=True, slots=True, eq=False)
class _View:
    """An orthographic camera: p_view = axes @ p_target; x right, y down, z away from the viewer."""

    axes: Float[np.ndarray, "3 3"]
    centre_m: Float[np.ndarray, "3"]
    px_per_m: float
    width: int
    height: int

    def pixels(self, points_m: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 2"]:
        """Corner-origin pixels of points in the target frame."""
        middle = np.array([self.width, self.height]) / 2
        return (points_m - self.centre_m) @ self.axes[:2].T * self.px_per_m + middle


def contact_sheet(target: Target, size_px: int = 480, columns: int = 4) -> Image:
    """All views as one BGR picture, at one scale; keypoints that a view sees are bright and numbered, others grey."""
    views = _views(target, size_px)
    tiles = [_tile(target, name, view) for (name, _, _), view in zip(VIEWS, views, strict=True)]
    rows = [np.hstack(tiles[i : i + columns]) for i in range(0, len(tiles), columns)]
    width = rows[0].shape[1]
    return np.vstack([_title(target, width), *rows, _legend(target, width)])


def write_contact_sheet(target: Target, path: Path, size_px: int) -> None:
    """Writes all views as a PNG or JPEG file."""
    if path.suffix.lower() not in (".png", ".jpg"):
        raise InputError(f"--out {path}: the preview is a picture; name it .png or .jpg")
    if not 100 <= size_px <= 4000:
        raise InputError(f"--size {size_px}: expected 100 to 4000 px")
    path.parent.mkdir(parents=True, exist_ok=True)
    if not cv2.imwrite(str(path), contact_sheet(target, size_px)):
        raise InputError(f"{path}: cannot be written")


def _views(target: Target, width: int) -> list[_View]:
    """One camera per view; the common scale lets the widest view fill the tile's width or height."""
    low, high = target.vertices_m.min(axis=0), target.vertices_m.max(axis=0)
    centre = (low + high) / 2
    axes = [_axes(azimuth, elevation) for _, azimuth, elevation in VIEWS]
    reach = np.array([np.abs((target.vertices_m - centre) @ a[:2].T).max(axis=0) for a in axes]).max(axis=0)
    height = round(width * float(np.clip(1.1 * reach[1] / reach[0], 0.6, 1.0)))
    scale = 0.46 * min(width / reach[0], height / reach[1])
    return [_View(a, centre, scale, width, height) for a in axes]


def _axes(azimuth_deg: float, elevation_deg: float) -> Float[np.ndarray, "3 3"]:
    """Rows: right, down and away from the viewer, in the target frame; seen along z, +x is up."""
    a, e = np.radians(azimuth_deg), np.radians(elevation_deg)
    away = -np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), -np.sin(e)])
    down = np.array([-1.0, 0.0, 0.0]) if abs(elevation_deg) > 85 else np.array([0.0, 0.0, 1.0])
    right = unit(np.cross(down, away))
    return np.stack([right, np.cross(away, right), away])


def _tile(target: Target, name: str, view: _View) -> Image:
    image = np.ascontiguousarray(_shaded(target, view))
    _draw_axes(image, view)
    _draw_keypoints(image, target, view)
    _draw_rule(image, view)
    cv2.putText(image, name, (10, 20), _FONT, 0.5, _INK, 1, cv2.LINE_AA)
    cv2.rectangle(image, (0, 0), (view.width - 1, view.height - 1), (70, 66, 60), 1)
    return image


def _shaded(target: Target, view: _View) -> Image:
    """Nominal albedos under a lamp above the viewer's left shoulder and a weak fill; four rays a pixel."""
    rows, columns = 2 * view.height, 2 * view.width
    x, y = np.meshgrid((np.arange(columns) + 0.5 - columns / 2) / 2, (np.arange(rows) + 0.5 - rows / 2) / 2)
    flat = np.stack([x.ravel(), y.ravel()], axis=1) / view.px_per_m
    start = view.centre_m - 4 * target.size_m * view.axes[2] + flat @ view.axes[:2]
    distance, face = first_faces(target, start, np.broadcast_to(view.axes[2], start.shape))
    hit = face >= 0
    normal = unit(target.corner_normals.mean(axis=1)[face[hit]] + 1e-12)
    lamp = unit(np.array([-0.5, -0.7, -1.0]) @ view.axes)
    shade = 0.25 + 0.75 * np.clip(normal @ lamp, 0.0, 1.0)
    albedo = _albedo(target, face[hit], start[hit] + distance[hit, None] * view.axes[2])
    linear = np.tile((np.array(_BACKGROUND[::-1]) / 255.0) ** 2.2, (rows * columns, 1))
    linear[hit] = np.clip(albedo * shade[:, None], 0.0, 1.0)
    mean = linear.reshape(view.height, 2, view.width, 2, 3).mean(axis=(1, 3))
    return (255 * mean ** (1 / 2.2)).astype(np.uint8)[..., ::-1]


def _albedo(target: Target, face: Int[np.ndarray, "n"], point_m: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    """Linear albedo of points on faces: of the picture on the part where there is one, else of its material."""
    part = target.face_part[face]
    albedo = np.array([m.albedo for m in target.materials])[part]
    for name, image in target.images.items():
        chosen = part == target.part_names.index(name)
        corners = target.vertices_m[target.faces[face[chosen]]]
        weight = _barycentric(corners, point_m[chosen])
        uv = np.einsum("nc,nck->nk", weight, target.corner_uv_m[face[chosen]]) / image.tile_m % 1.0
        h, w = image.srgb.shape[:2]
        row, column = np.minimum((uv[:, 1] * h).astype(int), h - 1), np.minimum((uv[:, 0] * w).astype(int), w - 1)
        albedo[chosen] = linear_texels(image)[row, column]
    return albedo


def _barycentric(corners: Float[np.ndarray, "n 3 3"], point: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    """Shares of the corners of triangles in points on them."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    square = np.maximum(np.einsum("ij,ij->i", normal, normal), 1e-300)
    v = np.einsum("ij,ij->i", np.cross(point - a, c - a), normal) / square
    w = np.einsum("ij,ij->i", np.cross(b - a, point - a), normal) / square
    return np.stack([1.0 - v - w, v, w], axis=1)


def _draw_axes(image: Image, view: _View) -> None:
    """The frame's axes from its origin, a tenth of the picture long, where the picture shows it."""
    reach = 0.1 * view.width / view.px_per_m
    ends = np.round(view.pixels(np.vstack([np.zeros(3), reach * np.eye(3)]))).astype(int)
    if not ((ends[0] >= 0) & (ends[0] < [view.width, view.height])).all():
        return
    for end, name, colour in zip(ends[1:], "xyz", _AXES, strict=True):
        if np.abs(end - ends[0]).max() > 4:
            cv2.line(image, ends[0].tolist(), end.tolist(), colour, 2, cv2.LINE_AA)
            cv2.putText(image, name, (end + 3).tolist(), _FONT, 0.42, colour, 1, cv2.LINE_AA)


def _draw_keypoints(image: Image, target: Target, view: _View) -> None:
    """Dots, and the numbers of those that are seen, pushed down until they do not cover one another."""
    eyes = target.keypoints_m - 8 * target.size_m * view.axes[2]
    hidden = occluded(target, target.keypoints_m, eyes, HIT_TOLERANCE * target.size_m)
    taken: list[tuple[int, int]] = []
    for k in np.argsort(hidden, kind="stable").tolist():
        x, y = (round(v) for v in view.pixels(target.keypoints_m[k : k + 1])[0].tolist())
        cv2.circle(image, (x, y), 3, _HIDDEN if hidden[k] else _SEEN, 1 if hidden[k] else -1, cv2.LINE_AA)
        if not hidden[k]:
            _number(image, str(k), x + 5, y - 4, taken)


def _number(image: Image, text: str, left: int, low: int, taken: list[tuple[int, int]]) -> None:
    while any(abs(low - y) < 13 and abs(left - x) < 18 for x, y in taken):
        low += 4
    taken.append((left, low))
    cv2.putText(image, text, (left, low), _FONT, 0.42, _BACKGROUND, 3, cv2.LINE_AA)
    cv2.putText(image, text, (left, low), _FONT, 0.42, _SEEN, 1, cv2.LINE_AA)


def _legend(target: Target, width: int) -> Image:
    """Numbers and names of the keypoints in columns; those of the subset `six` are marked."""
    six, columns = target.subsets.get("six", ()), max(1, width // 240)
    rows = -(-len(target.keypoint_names) // columns)
    bar = np.full((20 * rows + 16, width, 3), _BACKGROUND, np.uint8)
    for k, name in enumerate(target.keypoint_names):
        place = (10 + (k // rows) * (width // columns), 22 + 20 * (k % rows))
        text = f"{k} {name}{'  (six)' if k in six else ''}"
        cv2.putText(bar, text, place, _FONT, 0.42, _SEEN, 1, cv2.LINE_AA)
    return bar


def _draw_rule(image: Image, view: _View) -> None:
    """A bar of 1, 2 or 5 times a power of ten metres, about a fifth of the picture."""
    room = 0.25 * view.width / view.px_per_m
    decade = 10.0 ** np.floor(np.log10(room))
    length = max(f * decade for f in (1, 2, 5) if f * decade <= room)
    end, y = 10 + round(length * view.px_per_m), view.height - 14
    cv2.line(image, (10, y), (end, y), _INK, 1)
    for x in (10, end):
        cv2.line(image, (x, y - 4), (x, y + 4), _INK, 1)
    cv2.putText(image, f"{length:g} m", (end + 6, y + 4), _FONT, 0.42, _INK, 1, cv2.LINE_AA)


def _title(target: Target, width: int) -> Image:
    size = " x ".join(f"{v:.2f}" for v in np.ptp(target.vertices_m, axis=0))
    text = f"{target.name}: {size} m (x, y, z), {len(target.faces)} triangles, "
    text += f"{len(target.part_names)} parts, {len(target.keypoint_names)} keypoints"
    bar = np.full((36, width, 3), _BACKGROUND, np.uint8)
    cv2.putText(bar, text, (10, 24), _FONT, 0.55, _INK, 1, cv2.LINE_AA)
    return bar
