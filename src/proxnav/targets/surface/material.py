"""How a surface reflects: one small model that both renderers evaluate the same way.

    f = (1 - m) [ (1 - F) albedo / pi + F g(roughness) ] + m albedo g(roughness)

m is `metallic`, F the unpolarised Fresnel reflectance of a dielectric of index `ior` at the angle between the normal
and the view, g the GGX microfacet lobe with alpha = roughness^2 and height-correlated Smith shadowing (B. Walter et
al., "Microfacet models for refraction through rough surfaces", EGSR 2007; E. Heitz, JCGT 3(2), 2014).
"""

from dataclasses import dataclass
from typing import Literal

MaterialKind = Literal["plain", "tile", "insulation", "foil", "solar_cell", "radiator", "metal"]
"""Family of procedural textures: which pattern `textures.part_texture` draws on the surface."""


@dataclass(frozen=True)
class Material:
    """Nominal reflectance of a part; textures modulate it over the surface."""

    kind: MaterialKind = "plain"
    albedo: tuple[float, float, float] = (0.5, 0.5, 0.5)
    """Diffuse reflectance, or the metal's colour, in the bands 600-700, 500-600 and 400-500 nm."""
    metallic: float = 0.0
    roughness: float = 0.5
    ior: float = 1.5
    """1 removes the dielectric highlight: a pure Lambertian surface when metallic is 0."""
    emission: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Radiance [W/(m^2 sr)] that the surface emits, for markers and lamps."""
