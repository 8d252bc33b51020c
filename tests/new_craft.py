"""Three craft that no shipped model has seen, drawn from parameters: a 6U CubeSat, a relay with two dishes, a tug.

    python tests/new_craft.py out/craft        # cubesat.step, relay.glb, tug.glb

Millimetres (STEP) or metres (GLB, y up, z forward); the box has its origin at a corner.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import trimesh
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from proxnav.targets.solids import Piece, aim, box, revolve, rod
from step_files import cuboid, write_step

GLTF = np.array([[0.0, -1, 0], [0, 0, -1], [1, 0, 0]])
"""R_gltf_craft: forward, right, down to the axes of glTF, which are left, up, forward."""
BLUE, BROWN = (24, 42, 110), (120, 78, 40)


def cubesat_step(path: Path) -> Path:
    """A bare 6U box, 226.3 x 100 x 366 mm with a corner at the origin: eight corners, sides of different colours."""
    foil, cover, dark, cell = (0.8, 0.6, 0.3), (0.75, 0.75, 0.78), (0.25, 0.25, 0.27), (0.15, 0.2, 0.5)
    return write_step(path, [cuboid("bus", (0, 0, 0), (226.3, 100.0, 366.0), (cell, dark, cell, foil, cover, dark))])


def relay_glb(path: Path) -> Path:
    """A data relay: hexagonal bus, two dishes of 4.9 m, two panels of cells, a smaller dish and an S-band array."""
    paint, gold, grey = _metal((0.75, 0.76, 0.78), 0.0), _metal((0.8, 0.6, 0.25), 1.0), _metal((0.3, 0.3, 0.32), 0.0)
    scene = trimesh.Scene()
    _add(scene, "bus", [_prism("bus", 6, 1.25, 2.3)], gold)
    for side in (-1.0, 1.0):
        place = (1.5, 4.2 * side, -0.4)
        _add(scene, f"dish_{'lr'[side > 0]}", [aim(_dish("d", 2.45, 0.9), place, (0.9, 0.25 * side, 0.2))], paint)
        _add(scene, f"boom_{'lr'[side > 0]}", [rod("b", (0.9, 0.9 * side, -0.2), place, 0.09)], grey)
        _panel(scene, f"panel_{'lr'[side > 0]}", (-1.4, 2.2 * side, 0.1), (1.3, 4.2 * side), 0.04)
    _add(scene, "downlink", [aim(_dish("d", 1.0, 0.35), (-0.2, 0.0, 1.7), (0.1, 0.0, 1.0))], paint)
    _add(scene, "array", [box("a", (1.16, -0.8, -0.7), (1.36, 0.8, 0.9))], grey)
    _add(scene, "mast", [rod("m", (-0.5, 0.3, -1.2), (-0.5, 0.3, -2.6), 0.05)], grey)
    scene.export(path)
    return path


def tug_glb(path: Path) -> Path:
    """A servicing tug: octagonal bus with a docking ring, one large panel, a folded arm, tanks and a nozzle."""
    foil, white, dark = _metal((0.75, 0.55, 0.2), 1.0), _metal((0.8, 0.8, 0.8), 0.0), _metal((0.08, 0.08, 0.09), 0.0)
    scene = trimesh.Scene()
    _add(scene, "bus", [_prism("bus", 8, 0.75, 1.6)], foil)
    _add(scene, "ring", [aim(_ring("r", 0.45, 0.55, 0.12), (0.8, 0.0, 0.0), (1.0, 0.0, 0.0))], white)
    nozzle = revolve("n", [(-0.8, 0.09), (-1.25, 0.33), (-1.26, 0.31), (-0.82, 0.07)])
    _add(scene, "nozzle", [nozzle], dark)
    _panel(scene, "panel", (-0.45, 0.95, -0.05), (0.9, 2.4), 0.03)
    _add(scene, "yoke", [rod("y", (0.0, 0.6, -0.03), (0.0, 1.0, -0.03), 0.03)], dark)
    joints = [(0.7, -0.45, -0.6), (0.1, -1.0, -1.0), (1.1, -1.25, -0.75), (1.35, -0.95, -0.5)]
    arm = [rod(f"a{i}", joints[i], joints[i + 1], 0.06) for i in range(3)]
    _add(scene, "arm", arm, white)
    _add(scene, "radiator", [box("r", (-0.6, -1.5, 0.55), (0.5, -0.7, 0.58))], white)
    _add(scene, "head", [box("h", (0.55, -0.2, -1.15), (0.85, 0.15, -0.72))], dark)
    scene.export(path)
    return path


def cells(rows: int, columns: int, side: int = 32) -> Image.Image:
    """Solar cells: blue with a brown rim."""
    cell = np.full((side, side, 3), BROWN, np.uint8)
    rim = max(1, side // 10)
    cell[rim:-rim, rim:-rim] = BLUE
    return Image.fromarray(np.tile(cell, (rows, columns, 1)))


def _metal(rgb: tuple[float, float, float], metallic: float) -> PBRMaterial:
    return PBRMaterial(baseColorFactor=[*rgb, 1.0], metallicFactor=metallic, roughnessFactor=0.45)


def _add(scene: trimesh.Scene, name: str, pieces: Sequence[Piece], material: PBRMaterial) -> None:
    """Adds pieces as one node, in the axes of glTF."""
    mesh = trimesh.util.concatenate([trimesh.Trimesh(p.vertices_m @ GLTF.T, p.faces, process=False) for p in pieces])
    mesh.visual = TextureVisuals(uv=np.zeros((len(mesh.vertices), 2)), material=material)
    scene.add_geometry(mesh, geom_name=name)


def _panel(
    scene: trimesh.Scene, name: str, near: tuple[float, float, float], size: tuple[float, float], thick: float
) -> None:
    """A plate along y from `near`, cells on top (up), brown below."""
    (x, y, z), (width, length) = near, size
    corners = np.array([[x, y], [x + width, y], [x + width, y + length], [x, y + length]])
    if length < 0:
        corners = corners[[1, 0, 3, 2]]
    top = np.column_stack([corners, np.full(4, z - thick / 2)])
    mesh = trimesh.Trimesh(top @ GLTF.T, [[0, 2, 1], [0, 3, 2]], process=False)
    image = cells(max(2, round(abs(length) / 0.3)), max(2, round(width / 0.3)))
    cover = PBRMaterial(baseColorTexture=image, baseColorFactor=[1.0] * 4, metallicFactor=0.0, roughnessFactor=0.3)
    mesh.visual = TextureVisuals(uv=[[0, 0], [1, 0], [1, 1], [0, 1]], material=cover)
    scene.add_geometry(mesh, geom_name=f"{name}_cells")
    low, high = (x, min(y, y + length), z - thick / 2 + 1e-3), (x + width, max(y, y + length), z + thick / 2)
    _add(scene, f"{name}_back", [box("p", low, high)], _metal((0.35, 0.22, 0.1), 0.0))


def _prism(part: str, sides: int, radius: float, length: float) -> Piece:
    """A bus of some sides about the forward axis, its middle at the origin."""
    half = length / 2
    return revolve(part, [(half, 0.0), (half, radius), (-half, radius), (-half, 0.0)], sides)


def _dish(part: str, radius: float, depth: float) -> Piece:
    """A thin paraboloid that opens along +x, its vertex at the origin."""
    r = np.linspace(0.0, radius, 9)
    inner = [(float(depth * (v / radius) ** 2), float(v)) for v in r]
    outer = [(x - 0.03, v) for x, v in inner]
    return revolve(part, [*inner, *outer[::-1]], 40)


def _ring(part: str, inside: float, outside: float, length: float) -> Piece:
    return revolve(part, [(length, inside), (length, outside), (0.0, outside), (0.0, inside), (length, inside)], 32)


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    cubesat_step(folder / "cubesat.step"), relay_glb(folder / "relay.glb"), tug_glb(folder / "tug.glb")
