"""Your own spacecraft: a mesh file becomes a target with named keypoints that the rest of the chain takes."""

from pathlib import Path

import cv2
import trimesh

import proxnav as pn
from proxnav.targets.cad.from_mesh import from_mesh
from proxnav.targets.loading import load_target
from proxnav.targets.preview import contact_sheet
from proxnav.targets.target_files import save_target


def small_satellite(path: Path) -> Path:
    """A bus with two wings and an antenna, in millimetres, z up: what a CAD program would export."""
    bus = trimesh.creation.box((300.0, 200.0, 200.0))
    wings = [trimesh.creation.box((150.0, 700.0, 10.0)) for _ in range(2)]
    wings[0].apply_translation((0.0, 450.0, 0.0))
    wings[1].apply_translation((-40.0, -450.0, 0.0))
    antenna = trimesh.creation.cylinder(radius=60.0, height=80.0)
    antenna.apply_translation((90.0, 0.0, 140.0))
    path.parent.mkdir(parents=True, exist_ok=True)
    trimesh.util.concatenate([bus, *wings, antenna]).export(path)
    return path


def main(out: Path = Path("out/examples"), size: int = 320) -> pn.Target:
    """Reads the mesh, suggests keypoints, writes the target, and draws it from eight sides."""
    mesh = small_satellite(out / "satellite.stl")
    made = from_mesh(mesh, unit_m=0.001, up="z", forward="x", name="satellite", licence="CC0-1.0")
    save_target(made, out / "satellite")

    target = load_target(str(out / "satellite"))  # the folder is what `--target` takes
    length, width, height = target.vertices_m.max(axis=0) - target.vertices_m.min(axis=0)
    print(f"{target.name}: {length:.2f} x {width:.2f} x {height:.2f} m (forward, right, down)")
    for name, point in zip(target.keypoint_names[:6], target.keypoints_m[:6], strict=True):
        print(f"  {name:<24} {point.round(3)} m")

    picture = out / "03_target.png"
    cv2.imwrite(str(picture), contact_sheet(target, size))
    print(f"eight views in {picture}")
    return target


if __name__ == "__main__":
    main()
