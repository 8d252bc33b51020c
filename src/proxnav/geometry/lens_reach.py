"""How far into its image a lens leads rays: fitted polynomials may fold where no calibration point was."""

from dataclasses import dataclass

import numpy as np

from proxnav.geometry.camera import Camera

_STEPS = 65


@dataclass(frozen=True, slots=True)
class LensReach:
    """The part of an image that rays lead to."""

    share: float
    """Share of the image's area."""
    radius_px: float
    """Least distance from the principal point at which rays end."""


def lens_reach(camera: Camera) -> LensReach | None:
    """How far rays lead, or None where they lead to the whole image."""
    if not camera.is_distorted:
        return None
    u, v = np.meshgrid(np.linspace(0.0, camera.width, _STEPS), np.linspace(0.0, camera.height, _STEPS))
    pixels = np.stack([u, v], axis=-1)
    dark = np.isnan(camera.unproject(pixels)[..., 0])
    if not dark.any():
        return None
    distance = np.linalg.norm(pixels - (camera.cx, camera.cy), axis=-1)
    return LensReach(float(1.0 - dark.mean()), float(distance[dark].min()))
