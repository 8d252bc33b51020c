"""`proxnav target new`: a target from a mesh file, with what deserves a second look."""

from dataclasses import dataclass
from pathlib import Path

import tyro


@dataclass(frozen=True)
class TargetNewConfig:
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


def run(config: TargetNewConfig) -> None:
    """Makes the target, writes it, and says what deserves a second look."""
    from proxnav.cli.ask_unit import ask_unit
    from proxnav.missions import load_mission
    from proxnav.pose.solve.best_accuracy import accuracy_table
    from proxnav.targets.cad.from_mesh import from_mesh, unit_in_metres
    from proxnav.targets.description import description, second_looks
    from proxnav.targets.keypoints.point_files import load_points
    from proxnav.targets.preview import write_contact_sheet
    from proxnav.targets.target_files import save_target

    unit, length_m = config.unit, config.length_m
    if unit is None and length_m is None:
        unit, length_m = ask_unit(config.file, config.without)
    points = None if config.keypoints is None else load_points(config.keypoints)
    target = from_mesh(
        config.file, unit_in_metres(unit), config.up, config.forward, config.name, length_m, config.without, points,
        config.licence,
    )  # fmt: skip
    path = save_target(target, config.out)
    print(description(target))
    write_contact_sheet(target, config.out / "preview.png", 480)
    print(f"preview in {config.out / 'preview.png'}")
    for sentence in second_looks(target):
        print(f"look: {sentence}")
    print(accuracy_table(target, load_mission("observation-10-100m").camera))
    print(f"target in {path}; use it with --target {config.out}")
