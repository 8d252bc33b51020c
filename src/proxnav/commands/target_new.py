"""`proxnav target new`: a target from a mesh file, with what deserves a second look."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import tyro


@dataclass(frozen=True)
class TargetNewConfig:
    """Makes a target from a STEP, GLB, glTF, OBJ, STL, PLY, DAE or USD file: frame, scale, keypoints, preview."""

    file: tyro.conf.Positional[Path]
    """The mesh."""
    out: Path
    """Folder for target.json, mesh.npz and preview.png."""
    unit: str | None = None
    """The file's unit: m, dm, cm, mm, in, ft, or metres per unit as a number; STEP, DAE and USD declare it, else it is
    asked for at a terminal, else metres."""
    length_m: float | None = None
    """True length of the spacecraft's largest extent [m], in place of the unit."""
    up: str | None = None
    """File axis that points up, such as y or -z: turns the target frame to forward, right, down."""
    forward: str | None = None
    """File axis that points forward; the file's axes stay when neither is given."""
    origin: str = "file"
    """Origin of the target frame: the file's own, box (middle of the bounding box), or X,Y,Z in the file's unit."""
    centre_of_mass: str | None = None
    """Centre of mass as X,Y,Z in the file's axes and unit."""
    frame: tuple[str, ...] = ()
    """Frames as docking_port=X,Y,Z[,qw,qx,qy,qz] in the file's axes and unit, or a .json or .csv file of such."""
    without: tuple[str, ...] = ()
    """Parts to leave out."""
    keypoints: Path | None = None
    """Keypoints from .mat, .json or .csv; found automatically when not given."""
    keypoints_frame: Literal["target", "file"] = "target"
    """Whether those are in the target frame [m] or in the mesh file's axes and unit."""
    count: int = 24
    """How many keypoints to find, from 4; fewer where the mesh has fewer corners."""
    mission: str = "observation-10-100m"
    """Mission, by name or file, whose camera and nearest range say how fine the mesh must be."""
    name: str | None = None
    """Name of the target; the file's when not given."""
    licence: str = "unknown"
    """Licence of the mesh."""


def run(config: TargetNewConfig) -> None:
    """Makes the target, writes it, and says what deserves a second look."""
    from functools import partial

    from proxnav.cli.ask import ask_unit
    from proxnav.missions import load_mission
    from proxnav.pose.solve.best_accuracy import accuracy_table
    from proxnav.targets.cad.file_frames import frame_places
    from proxnav.targets.cad.from_mesh import from_mesh
    from proxnav.targets.cad.placement import unit_in_metres
    from proxnav.targets.description import description, second_looks
    from proxnav.targets.keypoints.point_files import load_points
    from proxnav.targets.preview import write_contact_sheet
    from proxnav.targets.target_files import save_target

    mission, unit, length_m = load_mission(config.mission), config.unit, config.length_m
    frames = frame_places(config.frame, config.centre_of_mass)
    points = None if config.keypoints is None else load_points(config.keypoints)
    if unit is None and length_m is None:
        unit, length_m = ask_unit(config.file, config.without)
    target = from_mesh(
        config.file, unit_in_metres(unit), config.up, config.forward, config.name, length_m, config.without, points,
        config.licence, config.origin, frames, config.keypoints_frame, config.count,
        mission.view.range_m[0] / mission.camera.fx, partial(print, flush=True),
    )  # fmt: skip
    path = save_target(target, config.out)
    print(description(target))
    write_contact_sheet(target, config.out / "preview.png", 480)
    looks = [f"look: {sentence}" for sentence in second_looks(target)]
    print("\n".join([f"preview in {config.out / 'preview.png'}", *looks]))
    print(accuracy_table(target, mission.camera))
    print(f"target in {path}; use it with --target {config.out}")
