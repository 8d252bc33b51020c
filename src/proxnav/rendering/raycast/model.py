"""All that ray casting keeps about a target between frames: triangles, Embree scene, textures and light-cache links."""

from collections import OrderedDict
from dataclasses import dataclass, field
from threading import Lock

import numpy as np

from proxnav.records import TextureSpec
from proxnav.rendering.raycast.config import RaycastConfig
from proxnav.rendering.raycast.light_cache import LightCache, build_cache
from proxnav.rendering.raycast.mesh import RenderMesh, build_mesh
from proxnav.rendering.raycast.texels import TexelTable, build_table
from proxnav.rendering.raycast.tracing import Tracer
from proxnav.targets import Target
from proxnav.targets.surface.textures import part_surfaces

_KEPT_TEXTURES = 8


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A target made ready for rays."""

    target: Target
    mesh: RenderMesh
    tracer: Tracer
    cache: LightCache
    _textures: OrderedDict[tuple[float, int], tuple[float, TexelTable]] = field(default_factory=OrderedDict)
    _lock: Lock = field(default_factory=Lock)

    def textures(self, spec: TextureSpec, finest_m: float = 0.0) -> TexelTable:
        """The texel table of one look of the target, good for footprints from `finest_m` on; the latest are kept.

        A table that is finer than asked for serves as well: what is read from it is the same to the bit.
        """
        key = (spec.strength, spec.seed if spec.strength > 0.0 else 0)
        finest_m = 2.0 ** np.floor(np.log2(max(finest_m, 1e-4)))
        with self._lock:
            kept = self._textures.get(key)
            if kept is None or kept[0] > finest_m:
                table = build_table(part_surfaces(self.target, *key), self.target.materials, finest_m)
                kept = self._textures[key] = (finest_m, table)
                if len(self._textures) > _KEPT_TEXTURES:
                    self._textures.popitem(last=False)
            self._textures.move_to_end(key)
            return kept[1]


def build_model(target: Target, config: RaycastConfig) -> Model:
    """Everything that depends on the target and not on the frame."""
    mesh = build_mesh(target, config.ambient_spacing_m)
    tracer = Tracer(mesh.vertices, mesh.faces)
    return Model(target, mesh, tracer, build_cache(mesh, tracer, config.ambient_rays, config.environment_rows))
