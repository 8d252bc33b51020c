"""Reflectances of a file's mesh: factors of its material, the picture on it, or the few tones of its face colours."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from proxnav.targets.cad.image_tile import Picture
from proxnav.targets.surface.part_image import srgb_to_linear

MAX_TONES = 4
MIN_SPREAD = 0.06
"""Standard deviation of linear albedo over a part above which its face colours are split by tone."""
_TINY = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class FileMaterial:
    """What a mesh of a file reflects."""

    face_tone: Int[np.ndarray, "n_faces"]
    """Which of `albedo` each face has."""
    albedo: Float[np.ndarray, "n_tones 3"]
    metallic: float
    roughness: float
    picture: Picture | None = None
    """Base colour over the surface, on top of which `albedo` is a factor."""


def file_material(mesh: Any) -> FileMaterial:
    """The material of a trimesh mesh; grey 0.5 where the file says nothing."""
    visual = mesh.visual
    material = getattr(visual, "material", None)
    if material is None:
        return _coloured(mesh, visual)
    if not hasattr(material, "baseColorFactor"):
        material = material.to_pbr()
    factor = _factor(material.baseColorFactor)
    metallic = 0.0 if material.metallicFactor is None else float(np.clip(material.metallicFactor, 0, 1))
    roughness = 0.6 if material.roughnessFactor is None else float(np.clip(material.roughnessFactor, 0.05, 1))
    image, uv = material.baseColorTexture, getattr(visual, "uv", None)
    picture = None
    if image is not None and uv is not None and len(uv) == len(mesh.vertices):
        picture = Picture(image, np.nan_to_num(np.asarray(uv, np.float64))[np.asarray(mesh.faces)])
    return FileMaterial(
        np.zeros(len(mesh.faces), dtype=np.int64), np.clip(factor, 0.0, 1.0)[None], metallic, roughness, picture
    )


def _factor(value: Any) -> Float[np.ndarray, "3"]:
    """A base colour factor, linear by the glTF specification, as trimesh keeps it (bytes or floats)."""
    if value is None:
        return np.ones(3)
    array = np.asarray(value)
    return array[:3].astype(np.float64) / (255.0 if array.dtype == np.uint8 else 1.0)


def _coloured(mesh: Any, visual: Any) -> FileMaterial:
    """Colours of vertices or faces, sRGB by custom, as a few tones; grey when there are none."""
    if getattr(visual, "kind", None) not in ("vertex", "face"):
        return _tones(np.full((len(mesh.faces), 3), 0.5), np.ones(len(mesh.faces)))
    colours = srgb_to_linear(np.asarray(visual.face_colors, np.float64)[:, :3] / 255.0)
    return _tones(colours, np.asarray(mesh.area_faces))


def _tones(colours: Float[np.ndarray, "n_faces 3"], area: Float[np.ndarray, "n_faces"]) -> FileMaterial:
    weight = (area + _TINY) / (area + _TINY).sum()
    mean = weight @ colours
    spread = float(np.sqrt((weight @ (colours - mean) ** 2).sum()))
    if spread < MIN_SPREAD or len(colours) < 2 * MAX_TONES:
        return FileMaterial(np.zeros(len(colours), dtype=np.int64), np.clip(mean, 0.0, 1.0)[None], 0.0, 0.6)
    order = np.argsort(colours.sum(axis=1))
    start = colours[order[np.linspace(0, len(order) - 1, MAX_TONES).astype(int)]]
    start = np.unique(start.round(6), axis=0)
    label = np.argmin(np.linalg.norm(colours[:, None] - _centres(colours, start), axis=2), axis=1)
    used, face_tone = np.unique(label, return_inverse=True)
    albedo = np.array([np.average(colours[label == i], axis=0, weights=weight[label == i]) for i in used])
    return FileMaterial(face_tone.reshape(-1).astype(np.int64), albedo, 0.0, 0.6)


def _centres(colours: Float[np.ndarray, "n 3"], start: Float[np.ndarray, "k 3"]) -> Float[np.ndarray, "k 3"]:
    """Lloyd's k-means from a given start; a centre that loses all its colours stays where it was."""
    centres = start.copy()
    for _ in range(20):
        label = np.argmin(np.linalg.norm(colours[:, None] - centres, axis=2), axis=1)
        for k in np.unique(label):
            centres[k] = colours[label == k].mean(axis=0)
    return centres
