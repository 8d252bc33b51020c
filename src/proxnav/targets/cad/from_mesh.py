"""A Target from a CAD or graphics file: unit, axes, origin, parts, pictures, named frames and keypoints."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Bool

from proxnav.geometry.types import Points
from proxnav.targets.assembly import assemble
from proxnav.targets.cad.decimation import decimated
from proxnav.targets.cad.file_frames import FILE_FRAME, FramePlace
from proxnav.targets.cad.image_tile import MAX_TEXELS, image_tile, mean_albedo
from proxnav.targets.cad.mesh_file import read_mesh
from proxnav.targets.cad.mesh_part import MeshPart
from proxnav.targets.cad.placement import placement
from proxnav.targets.cad.soundness import outward
from proxnav.targets.keypoints.choice import suggest_keypoints
from proxnav.targets.keypoints.point_files import Loaded
from proxnav.targets.keypoints.spread import farthest_points
from proxnav.targets.solids import Piece
from proxnav.targets.target import Target

KeypointsFrame = Literal["target", "file"]
N_KEYPOINTS = 24
N_SUBSET = 6
PIXEL_M = 0.007
"""What a pixel covers at 10 m with the navigation camera of 1407 px."""


def unheard(sentence: str) -> None:
    """Takes what is said about a long job and says nothing."""
    del sentence


def from_mesh(
    path: Path | str,
    unit_m: float | None = None,
    up: str | None = None,
    forward: str | None = None,
    name: str | None = None,
    length_m: float | None = None,
    without: Sequence[str] = (),
    keypoints: Loaded | None = None,
    licence: str = "unknown",
    origin: str = "file",
    frames: Mapping[str, FramePlace] | None = None,
    keypoints_frame: KeypointsFrame = "target",
    count: int = N_KEYPOINTS,
    pixel_m: float = PIXEL_M,
    say: Callable[[str], None] = unheard,
) -> Target:
    """The spacecraft in a GLB, glTF, STEP, OBJ, STL, PLY, DAE or USD file, in the file's own frame, in metres.

    The unit that the file declares (STEP, DAE, USD) gives the scale, else one of `unit_m` (metres per file unit) and
    `length_m` (true length of the largest extent); with neither it is metres, and refused when that makes no
    spacecraft. `origin` (file, box, or X,Y,Z in file coordinates) moves the target frame; `up` or `forward`, axes of
    the file, turn it to forward, right, down. `frames` are given in the file's coordinates, and so are `keypoints`
    where `keypoints_frame` says so; without keypoints up to `count` are found. `pixel_m`, what a pixel covers at the
    nearest range, says how finely a mesh of millions of triangles is kept. `say` hears one sentence for each slow step
    and each change of the mesh.
    """
    path = Path(path)
    say(f"reading {path.name}")
    mesh = read_mesh(path).without(path, without)
    place = placement(path, mesh, unit_m, length_m, up, forward, origin)
    parts = [replace(part, vertices=place.points_m(part.vertices)) for part in mesh.parts]
    parts = _outward(decimated(parts, pixel_m, say), say)
    target = _assembled(parts, name or path.stem, licence, f"{path.name}, 1 unit = {place.scale_m:.6g} m")
    named = {key: place.frame(key, value) for key, value in (frames or {}).items()}
    target = replace(target, frames={FILE_FRAME: place.file_frame()} | named)
    if keypoints is None:
        say(f"choosing keypoints on {len(target.faces)} triangles")
        points, names = suggest_keypoints(target, count)
        if len(points) < count:
            say(f"{len(points)} keypoints: the mesh has no more distinct corners that are often seen")
        return with_keypoints(target, points, names)
    points, names = keypoints
    return with_keypoints(target, place.points_m(points) if keypoints_frame == "file" else points, names)


def file_extents(path: Path, without: Sequence[str] = ()) -> tuple[tuple[float, float, float], float | None]:
    """(extents along the file's axes x, y, z in its own unit, metres per unit where the file declares it)."""
    mesh = read_mesh(path).without(path, without)
    low, high = mesh.box()
    x, y, z = (high - low).tolist()
    return (x, y, z), mesh.unit_m


def with_keypoints(target: Target, points_m: Points, names: Sequence[str]) -> Target:
    """The target with these keypoints and, from six on, a well spread subset `six`."""
    first = int(np.argmax(np.linalg.norm(points_m - points_m.mean(axis=0), axis=1)))
    six = tuple(farthest_points(points_m, N_SUBSET, first)) if len(points_m) >= N_SUBSET else ()
    subsets = {"six": six} if six else {}
    return replace(target, keypoints_m=points_m, keypoint_names=tuple(names), subsets=subsets)


def isolated_parts(target: Target, gap: float = 0.25) -> list[str]:
    """Parts whose bounding box is no neighbour, even through others, of the largest part's: `gap` is in its diagonals.

    Files often hold leftovers far off the spacecraft; name them in `without`.
    """
    corners = target.vertices_m[target.faces]
    boxes = [corners[target.face_part == i].reshape(-1, 3) for i in range(len(target.part_names))]
    low, high = np.array([b.min(axis=0) for b in boxes]), np.array([b.max(axis=0) for b in boxes])
    main = int(np.argmax(np.linalg.norm(high - low, axis=1)))
    group, reach = {main}, gap * float(np.linalg.norm(high[main] - low[main]))
    while True:
        lo, hi = low[list(group)].min(axis=0), high[list(group)].max(axis=0)
        apart = np.linalg.norm(np.maximum(0.0, np.maximum(low - hi, lo - high)), axis=1)
        grown = group | set(np.flatnonzero(apart < reach).tolist())
        if grown == group:
            return [target.part_names[i] for i in range(len(boxes)) if i not in group]
        group = grown


def _outward(parts: Sequence[MeshPart], say: Callable[[str], None]) -> list[MeshPart]:
    """The parts with triangles that face outward where that can be decided."""
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    faces = np.concatenate([part.faces + start for part, start in zip(parts, starts[:-1], strict=True)])
    _, turned = outward(np.concatenate([part.vertices for part in parts]), faces)
    if turned.any():
        say(f"{int(turned.sum())} of {len(turned)} triangles faced inward and are turned outward")
    ends = np.cumsum([0, *(len(part.faces) for part in parts)])
    return [_turned(part, turned[a:b]) for part, a, b in zip(parts, ends[:-1], ends[1:], strict=True)]


def _turned(part: MeshPart, which: Bool[np.ndarray, "m"]) -> MeshPart:
    """The part with some triangles wound the other way."""
    faces = np.where(which[:, None], part.faces[:, ::-1], part.faces)
    if part.picture is None:
        return replace(part, faces=faces)
    uv = np.where(which[:, None, None], part.picture.corner_uv[:, ::-1], part.picture.corner_uv)
    return replace(part, faces=faces, picture=replace(part.picture, corner_uv=uv))


def _assembled(parts: Sequence[MeshPart], name: str, licence: str, source: str) -> Target:
    """The target without keypoints, pictures laid on as tiles."""
    pieces = [Piece(part.name, part.vertices, part.faces) for part in parts]
    target = assemble(name, pieces, {part.name: part.material for part in parts}, {}, {}, licence, source)
    share = MAX_TEXELS // max(1, sum(part.picture is not None for part in parts))
    uv, materials, images = np.array(target.corner_uv_m), list(target.materials), {}
    for index, part in enumerate(parts):
        if part.picture is not None:
            corners_m, of_part = part.vertices[part.faces], target.face_part == index
            image, uv[of_part] = image_tile(part.picture, corners_m, np.array(part.material.albedo), share)
            albedo = mean_albedo(image, uv[of_part], corners_m)
            images[part.name], materials[index] = image, replace(part.material, albedo=albedo)
    return replace(target, corner_uv_m=uv, materials=tuple(materials), images=images)
