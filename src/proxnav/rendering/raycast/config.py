"""What one may choose about ray casting: how many rays, and where they go."""

from dataclasses import dataclass

from proxnav.errors import InputError


@dataclass(frozen=True)
class RaycastConfig:
    """Quality against time; none of it changes what is true about the scene, only how finely it is sampled."""

    samples: int = 8
    """Camera rays per pixel where a silhouette, a crease or the edge of a shadow crosses it, for antialiasing."""
    interior_samples: int = 1
    """Camera rays per pixel everywhere else; 1 is the ray through the pixel's centre, textures are filtered anyway."""
    sun_samples: int = 8
    """Rays to the Sun's disc per pixel in the refined pixels, for the soft shadow; at least one per camera ray."""
    bounces: int = 2
    """Reflections between surfaces of the target that the diffuse light cache follows; 0: only Sun and Earth."""
    ambient_rays: int = 96
    """Directions in which each point of the light cache looks for Earth and for neighbouring surfaces."""
    ambient_spacing_m: float = 0.35
    """Largest edge between the points of the light cache."""
    environment_rows: int = 32
    """Rows of the equirectangular map of Earth and sky that lights the target."""
    reflections: bool = True
    """Trace one mirror ray from smooth surfaces, so that foil and cover glass show Earth and their neighbours."""

    def __post_init__(self) -> None:
        counts = (self.samples, self.interior_samples, self.sun_samples, self.ambient_rays, self.environment_rows)
        if min(counts) < 1 or self.bounces < 0 or not self.ambient_spacing_m > 0.0:
            raise InputError(
                f"ray casting needs at least one sample of each kind, bounces >= 0 and a positive spacing, found {self}"
            )

    @property
    def sun_rays_per_sample(self) -> int:
        """Rays to the Sun for each camera ray of a refined pixel."""
        return -(-self.sun_samples // self.samples)


QUICK = RaycastConfig(
    samples=4, sun_samples=4, bounces=0, ambient_rays=12, ambient_spacing_m=1.0, environment_rows=16, reflections=False
)
"""Quality that training crops and the check of a pose by its predicted view need."""
