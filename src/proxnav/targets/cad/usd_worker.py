"""Run by `converted.py` in a process of its own: the meshes of a USD stage as GLB, in the stage's own unit and axes."""

import io
import json
import sys
from pathlib import Path

import numpy as np
import trimesh
from PIL import Image
from pxr import Ar, Tf, Usd, UsdGeom, UsdShade
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

MAX_PICTURE_BYTES = 256 * 2**20


def main(source: str, out: str) -> None:
    """Writes the GLB and prints the unit and the axis that points up."""
    folder = Path(source).parent
    try:
        stage = Usd.Stage.Open(source)
    except Tf.ErrorException as error:
        raise SystemExit(str(error).split(" : ")[-1].strip("'\n")) from None
    check_references(stage, folder)
    places, scene = UsdGeom.XformCache(Usd.TimeCode.EarliestTime()), trimesh.Scene()
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
        if prim.IsA(UsdGeom.Imageable) and visible(prim):
            T = np.array(places.GetLocalToWorldTransform(prim)).T
            for name, mesh in meshes(prim, folder):
                scene.add_geometry(mesh, geom_name=name, transform=T)
    if not scene.geometry:
        raise SystemExit("holds no visible mesh, cube, sphere or cylinder")
    scene.export(out)
    said = {"metres_per_unit": UsdGeom.GetStageMetersPerUnit(stage), "up": UsdGeom.GetStageUpAxis(stage).lower()}
    print(json.dumps(said))


def check_references(stage, folder):
    """Ends where a layer refers to files outside the folder, or to one that is not there: a part would be missing."""
    for layer in stage.GetUsedLayers():
        for name in layer.GetCompositionAssetDependencies():
            place = Path(layer.realPath).parent / layer.ComputeAbsolutePath(name).split("[")[0]
            if "://" in name or not place.resolve().is_relative_to(folder):
                raise SystemExit(f"refers to {name[:80]} outside its folder; expected files beside it")
            if not place.is_file():
                raise SystemExit(f"refers to {name[:80]}, which is not there")


def visible(prim):
    """Whether a prim is drawn: not hidden, not a guide or a proxy."""
    image = UsdGeom.Imageable(prim)
    return image.ComputeVisibility() != "invisible" and image.ComputePurpose() in ("default", "render")


def meshes(prim, folder):
    """(name, trimesh) of each material's share of a prim; nothing for prims without a surface."""
    if prim.IsA(UsdGeom.Mesh):
        points, polygons, uv = mesh_arrays(UsdGeom.Mesh(prim))
    else:
        solid = primitive(prim)
        if solid is None:
            return
        points, polygons, uv = np.array(solid.vertices), [list(face) for face in solid.faces], None
    shares = subsets(prim, len(polygons))
    for number, (material, chosen) in enumerate(shares):
        corners, corner_uv = triangles(polygons, uv, chosen)
        if len(corners) == 0:
            continue
        mesh = trimesh.Trimesh(points[corners], np.arange(len(corners)).reshape(-1, 3), process=False)
        mesh.visual = TextureVisuals(uv=corner_uv, material=look(prim, material, folder))
        yield prim.GetName() if len(shares) == 1 else f"{prim.GetName()}_{number}", mesh


def mesh_arrays(mesh):
    """Points, polygons counter-clockwise seen from outside as lists of (point, corner), and corner uv or None."""
    time = Usd.TimeCode.EarliestTime()
    points = np.array(mesh.GetPointsAttr().Get(time) or np.zeros((0, 3)), dtype=np.float64).reshape(-1, 3)
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get(time) or [], dtype=np.int64)
    index = np.array(mesh.GetFaceVertexIndicesAttr().Get(time) or [], dtype=np.int64)
    if counts.sum() != len(index) or (len(index) and not 0 <= index.min() <= index.max() < len(points)):
        raise SystemExit(f"mesh {mesh.GetPath()} has faces that name missing points")
    ends = np.cumsum(counts)
    polygons = [list(range(end - count, end)) for count, end in zip(counts, ends, strict=True)]
    if mesh.GetOrientationAttr().Get() == "leftHanded":
        polygons = [polygon[::-1] for polygon in polygons]
    return points[index], polygons, corner_uv(mesh, index)


def corner_uv(mesh, index):
    """Texture coordinates of each corner, None where the mesh has none."""
    for primvar in UsdGeom.PrimvarsAPI(mesh).GetPrimvarsWithValues():
        if primvar.GetTypeName().role == "TextureCoordinate" or primvar.GetPrimvarName() in ("st", "UVMap"):
            values = np.array(primvar.ComputeFlattened(), dtype=np.float64).reshape(-1, 2)
            if primvar.GetInterpolation() == "faceVarying" and len(values) == len(index):
                return values
            if primvar.GetInterpolation() in ("vertex", "varying") and len(values) > index.max(initial=-1):
                return values[index]
    return None


def subsets(prim, n_faces):
    """[(material prim, face indices)] of a prim's material subsets and of what they leave."""
    bound, left, shares = UsdShade.MaterialBindingAPI(prim), np.ones(n_faces, bool), []
    for subset in bound.GetMaterialBindSubsets():
        chosen = np.array(subset.GetIndicesAttr().Get() or [], dtype=np.int64)
        chosen = chosen[(chosen >= 0) & (chosen < n_faces)]
        left[chosen] = False
        shares.append((UsdShade.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()[0], chosen))
    if left.any():
        shares.append((bound.ComputeBoundMaterial()[0], np.flatnonzero(left)))
    return shares


def triangles(polygons, uv, chosen):
    """Corner indices of the triangles of the chosen polygons as a fan, and their texture coordinates."""
    corners = [
        c for face in chosen for p in [polygons[face]] for k in range(1, len(p) - 1) for c in (p[0], p[k], p[k + 1])
    ]
    corners = np.array(corners, dtype=np.int64)
    return corners, None if uv is None or len(corners) == 0 else uv[corners]


def look(prim, material, folder):
    """Base colour, metallic and roughness of a UsdPreviewSurface, or the prim's display colour."""
    shader = material.ComputeSurfaceSource()[0] if material else None
    if shader:
        colour, picture = input_of(shader, "diffuseColor", (0.18, 0.18, 0.18), folder)
        metallic, roughness = (input_of(shader, n, v, folder)[0] for n, v in (("metallic", 0.0), ("roughness", 0.5)))
    else:
        shown = UsdGeom.Gprim(prim).GetDisplayColorAttr().Get() if prim.IsA(UsdGeom.Gprim) else None
        colour, picture, metallic, roughness = (shown[0] if shown else (0.5, 0.5, 0.5)), None, 0.0, 0.6
    factor = [1.0, 1.0, 1.0, 1.0] if picture is not None else [*(float(v) for v in colour), 1.0]
    return PBRMaterial(
        baseColorFactor=np.round(255 * np.clip(factor, 0, 1)).astype(np.uint8), baseColorTexture=picture,
        metallicFactor=float(metallic), roughnessFactor=float(roughness),
    )  # fmt: skip


def input_of(shader, name, default, folder):
    """(constant value, picture or None) of a shader's input."""
    port = shader.GetInput(name)
    if not port:
        return default, None
    source = port.GetConnectedSources()[0]
    if source and UsdShade.Shader(source[0].source.GetPrim()).GetIdAttr().Get() == "UsdUVTexture":
        asset = UsdShade.Shader(source[0].source.GetPrim()).GetInput("file").Get()
        return default, picture_of(asset, folder) if asset and name == "diffuseColor" else None
    value = port.Get()
    return (default if value is None or source else value), None


def picture_of(asset, folder):
    """The picture of an asset path within the folder or within the package; None where it is missing."""
    path = asset.resolvedPath
    if not path:
        return None
    if not Path(path.split("[")[0]).is_relative_to(folder):
        raise SystemExit(f"refers to the picture {asset.path[:80]} outside its folder")
    opened = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
    if opened is None or opened.GetSize() > MAX_PICTURE_BYTES:
        return None
    return Image.open(io.BytesIO(bytes(opened.GetBuffer()))).convert("RGB")


def primitive(prim):
    """A cube, sphere or cylinder as triangles; None for anything else."""
    if prim.IsA(UsdGeom.Cube):
        return trimesh.creation.box((UsdGeom.Cube(prim).GetSizeAttr().Get(),) * 3)
    if prim.IsA(UsdGeom.Sphere):
        return trimesh.creation.icosphere(3, UsdGeom.Sphere(prim).GetRadiusAttr().Get())
    if prim.IsA(UsdGeom.Cylinder):
        cylinder = UsdGeom.Cylinder(prim)
        solid = trimesh.creation.cylinder(cylinder.GetRadiusAttr().Get(), cylinder.GetHeightAttr().Get(), sections=48)
        turn = {"X": (2, 0, 1), "Y": (1, 2, 0), "Z": (0, 1, 2)}[cylinder.GetAxisAttr().Get()]
        solid.vertices = solid.vertices[:, turn]
        return solid
    return None


if __name__ == "__main__":
    main(*sys.argv[1:])
