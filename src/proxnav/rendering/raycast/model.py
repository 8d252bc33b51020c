"""All that ray casting keeps about a target between frames: triangles, Embree scene, textures and light-cache links."""

from collections import OrderedDict
from dataclasses import dataclass, field
from threading import Lock

from proxnav.datasets.records import TextureSpec
from proxnav.rendering.raycast.config import RaycastConfig
from proxnav.rendering.raycast.light_cache import LightCache, build_cache
from proxnav.rendering.raycast.mesh import RenderMesh, build_mesh
from proxnav.rendering.raycast.texels import TexelTable, build_table
from proxnav.rendering.raycast.tracing import Tracer
from proxnav.targets import Target
from proxnav.targets.textures import part_textures

_KEPT_TEXTURES = 8


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A target made ready for rays."""

    target: Target
    mesh: RenderMesh
    tracer: Tracer
    cache: LightCache
    _textures: OrderedDict[tuple[float, int], TexelTable] = field(default_factory=OrderedDict)
    _lock: Lock = field(default_factory=Lock)

    def textures(self, spec: TextureSpec) -> TexelTable:
        """The texel table of one look of the target; the latest few are kept."""
        key = (spec.strength, spec.seed if spec.strength > 0.0 else 0)
        with self._lock:
            if key not in self._textures:
                self._textures[key] = build_table(part_textures(self.target, *key), self.target.materials)
                if len(self._textures) > _KEPT_TEXTURES:
                    self._textures.popitem(last=False)
            self._textures.move_to_end(key)
            return self._textures[key]


def build_model(target: Target, config: RaycastConfig) -> Model:
    """Everything that depends on the target and not on the frame."""
    mesh = build_mesh(target, config.ambient_spacing_m)
    tracer = Tracer(mesh.vertices, mesh.faces)
    return Model(target, mesh, tracer, build_cache(mesh, tracer, config.ambient_rays, config.environment_rows))
