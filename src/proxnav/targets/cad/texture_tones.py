"""Reflectances of a file's mesh: its material's factors, and its base colour texture reduced to a few tones."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, Int

MAX_TONES = 4
MIN_SPREAD = 0.06
"""Standard deviation of linear albedo over a part above which it is split by tone."""
_TINY = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Tones:
    """Which of a few albedos each face has."""

    face_tone: Int[np.ndarray, "n_faces"]
    albedo: Float[np.ndarray, "n_tones 3"]
    metallic: float
    roughness: float


def face_tones(mesh: Any) -> Tones:
    """Tones of a trimesh mesh; grey 0.5 where the file says nothing."""
    visual = mesh.visual
    material = getattr(visual, "material", None)
    if material is None:
        return _uniform(len(mesh.faces), _plain_colour(visual), 0.0, 0.6)
    if not hasattr(material, "baseColorFactor"):
        material = material.to_pbr()
    factor = _factor(material.baseColorFactor)
    metallic = 0.0 if material.metallicFactor is None else float(np.clip(material.metallicFactor, 0, 1))
    roughness = 0.6 if material.roughnessFactor is None else float(np.clip(material.roughnessFactor, 0.05, 1))
    image, uv = material.baseColorTexture, getattr(visual, "uv", None)
    if image is None or uv is None or len(uv) != len(mesh.vertices):
        return _uniform(len(mesh.faces), factor, metallic, roughness)
    colours = np.clip(_sampled(image, np.asarray(uv, np.float64)[mesh.faces].mean(axis=1)) * factor, 0.0, 1.0)
    return _clustered(colours, np.asarray(mesh.area_faces), metallic, roughness)


def srgb_to_linear(values: Float[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
    """IEC 61966-2-1 decoding of values in [0, 1]."""
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def _factor(value: Any) -> Float[np.ndarray, "3"]:
    """A base colour factor, linear by the glTF specification, as trimesh keeps it (bytes or floats)."""
    if value is None:
        return np.ones(3)
    array = np.asarray(value)
    return array[:3].astype(np.float64) / (255.0 if array.dtype == np.uint8 else 1.0)


def _plain_colour(visual: Any) -> Float[np.ndarray, "3"]:
    """Vertex or face colours averaged, sRGB by custom; grey when there are none."""
    if getattr(visual, "kind", None) in ("vertex", "face"):
        return srgb_to_linear(np.asarray(visual.main_color, np.float64)[:3] / 255.0)
    return np.full(3, 0.5)


def _sampled(image: Any, uv: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 3"]:
    """Linear texture colour at uv (v upwards, as trimesh keeps it), on a copy of at most 256 texels a side."""
    small = image.convert("RGB")
    small.thumbnail((256, 256))
    texels = srgb_to_linear(np.asarray(small, np.float64) / 255.0)
    h, w = texels.shape[:2]
    uv = np.nan_to_num(uv) % 1.0
    column = np.minimum((uv[:, 0] * w).astype(int), w - 1)
    row = np.minimum(((1.0 - uv[:, 1]) % 1.0 * h).astype(int), h - 1)
    return texels[row, column]


def _uniform(n_faces: int, albedo: Float[np.ndarray, "3"], metallic: float, roughness: float) -> Tones:
    return Tones(np.zeros(n_faces, dtype=np.int64), np.clip(albedo, 0.0, 1.0)[None], metallic, roughness)


def _clustered(
    colours: Float[np.ndarray, "n_faces 3"], area: Float[np.ndarray, "n_faces"], metallic: float, roughness: float
) -> Tones:
    weight = (area + _TINY) / (area + _TINY).sum()
    mean = weight @ colours
    spread = float(np.sqrt((weight @ (colours - mean) ** 2).sum()))
    if spread < MIN_SPREAD or len(colours) < 2 * MAX_TONES:
        return _uniform(len(colours), mean, metallic, roughness)
    order = np.argsort(colours.sum(axis=1))
    start = colours[order[np.linspace(0, len(order) - 1, MAX_TONES).astype(int)]]
    start = np.unique(start.round(6), axis=0)
    label = np.argmin(np.linalg.norm(colours[:, None] - _centres(colours, start), axis=2), axis=1)
    used, face_tone = np.unique(label, return_inverse=True)
    albedo = np.array([np.average(colours[label == i], axis=0, weights=weight[label == i]) for i in used])
    return Tones(face_tone.reshape(-1).astype(np.int64), albedo, metallic, roughness)


def _centres(colours: Float[np.ndarray, "n 3"], start: Float[np.ndarray, "k 3"]) -> Float[np.ndarray, "k 3"]:
    """Lloyd's k-means from a given start; a centre that loses all its colours stays where it was."""
    centres = start.copy()
    for _ in range(20):
        label = np.argmin(np.linalg.norm(colours[:, None] - centres, axis=2), axis=1)
        for k in np.unique(label):
            centres[k] = colours[label == k].mean(axis=0)
    return centres
