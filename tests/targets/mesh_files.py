"""A small craft to be written as a mesh file."""

import numpy as np
import trimesh
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial


def craft() -> trimesh.Scene:
    """A body 2 x 1 x 3 units (y up) with a mast on one side, in a scene whose nodes are moved."""
    scene = trimesh.Scene()
    grey = PBRMaterial(baseColorFactor=[0.2, 0.4, 0.6, 1.0], metallicFactor=1.0, roughnessFactor=0.3)
    body = trimesh.creation.box((2, 1, 3)).subdivide()
    body.visual = TextureVisuals(material=grey, uv=np.zeros((len(body.vertices), 2)))
    scene.add_geometry(body, geom_name="body", transform=np.diag([1.0, 1, 1, 1]))
    mast = trimesh.creation.cylinder(0.1, 2.0, sections=8)
    turn = np.array([[1.0, 0, 0, 0.8], [0, 0, -1, 1.5], [0, 1, 0, 1.0], [0, 0, 0, 1]])
    scene.add_geometry(mast, geom_name="mast", transform=turn)
    return scene
