"""`proxnav target`: look at a target, or make one from a mesh file."""

import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import tyro

from proxnav.errors import InputError
from proxnav.targets.target import Target


@dataclass(frozen=True)
class Show:
    """Draws a target from eight sides with its keypoints, and prints its size, parts and keypoints."""

    target: tyro.conf.Positional[str]
    """space-rider, a target.json or its folder, or a mesh file in metres."""
    out: Path | None = None
    """Picture to write, PNG; none when not given."""
    size: int = 480
    """Side of each view [px]."""


@dataclass(frozen=True)
class New:
    """Makes a target from a GLB, OBJ, STL or PLY file: scale, axes, keypoints, preview."""

    file: tyro.conf.Positional[Path]
    """The mesh."""
    out: Path
    """Folder for target.json, mesh.npz and preview.png."""
    unit: str | None = None
    """The file's unit: m, dm, cm, mm, in, ft, or metres per unit as a number; asked for at a terminal, else metres."""
    length_m: float | None = None
    """True length of the spacecraft's largest extent [m], in place of the unit."""
    up: str | None = None
    """File axis that points up, such as y or -z; glTF and OBJ: y, STL and PLY: z."""
    forward: str | None = None
    """File axis that points forward; glTF and OBJ: z, STL and PLY: x."""
    without: tuple[str, ...] = ()
    """Parts to leave out."""
    keypoints: Path | None = None
    """Keypoints in the target frame [m] from .mat, .json or .csv; found automatically when not given."""
    name: str | None = None
    """Name of the target; the file's when not given."""
    licence: str = "unknown"
    """Licence of the mesh."""


def show(config: Show) -> None:
    """Prints and draws an existing target."""
    from proxnav.commands.target_accuracy import accuracy_table
    from proxnav.missions import load_mission
    from proxnav.targets.loading import load_target

    target = load_target(config.target)
    print(description(target))
    print(accuracy_table(target, load_mission("observation-10-100m").camera))
    if config.out is not None:
        draw(target, config.out, config.size)


def new(config: New) -> None:
    """Makes a target, writes it, and says what deserves a second look."""
    from proxnav.commands.target_accuracy import accuracy_table
    from proxnav.missions import load_mission
    from proxnav.targets.cad.from_mesh import from_mesh
    from proxnav.targets.keypoints.point_files import load_points
    from proxnav.targets.target_files import save_target

    config = asked(config)
    target = from_mesh(
        config.file,
        unit_m=unit_in_metres(config.unit),
        up=config.up,
        forward=config.forward,
        name=config.name,
        length_m=config.length_m,
        without=config.without,
        keypoints=None if config.keypoints is None else load_points(config.keypoints),
        licence=config.licence,
    )
    path = save_target(target, config.out)
    print(description(target))
    draw(target, config.out / "preview.png", 480)
    for sentence in second_looks(target):
        print(f"look: {sentence}")
    print(accuracy_table(target, load_mission("observation-10-100m").camera))
    print(f"target in {path}; use it with --target {config.out}")


def second_looks(target: Target) -> Iterator[str]:
    """What deserves a second look: stray parts, turns that a network may confuse, weak keypoints."""
    from proxnav.targets.cad.from_mesh import isolated_parts
    from proxnav.targets.keypoints.choice import near_symmetries
    from proxnav.targets.keypoints.quality import complaints, mistaken

    for part in isolated_parts(target):
        yield f"part '{part}' lies far from the rest; leave it out with --without {part}"
    for turn in near_symmetries(target, np.random.default_rng(0)):
        pairs = mistaken(target, turn)
        yield (
            f"nearly unchanged by a turn of {turn.angle_deg:.0f} deg about its {turn.axis} (within {turn.gap:.1%} of "
            "the radius): a network may confuse the two poses unless materials tell them apart"
            + (f"; it would take {', '.join(pairs)}" if pairs else "")
        )
    yield from complaints(target)


def asked(config: New) -> New:
    """With the unit from the keyboard where neither unit nor length was given and somebody sits at it."""
    from proxnav.targets.cad.from_mesh import UNITS_M, file_extents

    if config.unit is not None or config.length_m is not None or not sys.stdin.isatty():
        return config
    extents = file_extents(config.file, config.without)
    largest = max(extents)
    print(f"{config.file}: {' x '.join(f'{v:.4g}' for v in extents)} units; its largest extent would be")
    for unit, metres in UNITS_M.items():
        print(f"  {unit:>3}: {largest * metres:.4g} m")
    answer = input("unit (m, dm, cm, mm, in, ft), or the true length of the largest extent, such as 13.2 m: ").strip()
    length = answer.removesuffix("m").strip()
    if answer.endswith("m") and answer not in UNITS_M and length.replace(".", "", 1).isdigit():
        return replace(config, length_m=float(length))
    return replace(config, unit=answer)


def unit_in_metres(unit: str | None) -> float | None:
    """Metres per file unit, from a unit's name or a number."""
    from proxnav.targets.cad.from_mesh import UNITS_M

    if unit is None or unit in UNITS_M:
        return None if unit is None else UNITS_M[unit]
    try:
        return float(unit)
    except ValueError:
        raise InputError(f"--unit {unit}: expected {', '.join(UNITS_M)} or metres per unit as a number") from None


def description(target: Target) -> str:
    """Size, source and keypoints as text."""
    size = " x ".join(f"{v:.3f}" for v in np.ptp(target.vertices_m, axis=0))
    lines = [
        f"{target.name}: {size} m (forward, right, down)",
        f"source: {target.source}; licence: {target.licence}",
        f"{len(target.vertices_m)} vertices, {len(target.faces)} triangles, {len(target.part_names)} parts",
    ]
    six = target.subsets.get("six", ())
    for k, (name, point) in enumerate(zip(target.keypoint_names, target.keypoints_m, strict=True)):
        mark = "  six" if k in six else ""
        lines.append(f"  {name:<24} {point[0]:8.3f} {point[1]:8.3f} {point[2]:8.3f} m{mark}")
    return "\n".join(lines)


def draw(target: Target, path: Path, size: int) -> None:
    """Writes the contact sheet."""
    import cv2

    from proxnav.targets.preview import contact_sheet

    if path.suffix.lower() not in (".png", ".jpg"):
        raise InputError(f"--out {path}: the preview is a picture; name it .png or .jpg")
    if not 100 <= size <= 4000:
        raise InputError(f"--size {size}: expected 100 to 4000 px")
    path.parent.mkdir(parents=True, exist_ok=True)
    if not cv2.imwrite(str(path), contact_sheet(target, size)):
        raise InputError(f"{path}: cannot be written")
    print(f"preview in {path}")
