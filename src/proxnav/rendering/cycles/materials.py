"""The target's surfaces as the worker's arrays."""

import numpy as np

from proxnav.records import TextureSpec
from proxnav.rendering.cycles.wire import Message
from proxnav.targets import Target
from proxnav.targets.surface.textures import part_textures


def paint_arrays(target: Target, texture: TextureSpec) -> Message:
    """The `paint` request: maps of albedo, of metallic and roughness, and of normals, per part."""
    parts, arrays = [], {}
    textures = part_textures(target, texture.strength, texture.seed)
    for index, (map_, material) in enumerate(zip(textures, target.materials, strict=True)):
        parts.append({"tile_m": map_.tile_m, "ior": map_.ior, "emission": material.emission})
        surface = np.stack([map_.metallic, map_.roughness, np.zeros_like(map_.metallic)], axis=-1)
        arrays[f"albedo{index}"] = map_.albedo.astype(np.float32)
        arrays[f"surface{index}"] = surface.astype(np.float32)
        if map_.normal is not None:
            arrays[f"normal{index}"] = (0.5 * map_.normal + 0.5).astype(np.float32)
    return {"command": "paint", "parts": parts}, arrays
