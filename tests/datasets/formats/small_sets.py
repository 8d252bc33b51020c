"""A small data set of ours, for tests that convert one."""

from pathlib import Path

import numpy as np

from boxcraft import boxcraft
from proxnav.datasets.set.labelling import label_frame
from proxnav.datasets.set.writer import DatasetWriter
from proxnav.geometry import Camera, quaternion
from proxnav.records import SceneSpec, SunSpec

CAMERA = Camera(64, 48, 60.0, 61.0, 32.0, 24.0, (-0.1, 0.02, 0.0, 0.001, 0.0))


def make_dataset(folder: Path, count: int = 6) -> Path:
    """Frames of the test box, 8 m to 100 m away, written as every data set of ours is."""
    rng = np.random.default_rng(7)
    ranges = np.linspace(8.0, 100.0, count)
    scenes = [
        SceneSpec(
            index + 3,
            "boxcraft",
            CAMERA,
            tuple(q),
            (0.02 * z, -0.03 * z, z),
            SunSpec((0.6, 0.0, 0.8)),
        )
        for index, (q, z) in enumerate(zip(quaternion.random(rng, count).tolist(), ranges.tolist(), strict=True))
    ]
    writer, target = DatasetWriter(folder), boxcraft()
    for scene in writer.begin(scenes, target):
        image = np.random.default_rng([7, scene.index]).integers(0, 255, (CAMERA.height, CAMERA.width), dtype=np.uint8)
        mask = np.zeros(image.shape, dtype=bool)
        mask[10:20, 20 : 31 + scene.index] = True
        writer.add(scene, image, mask, label_frame(scene, target, mask, np.arange(8) % 3 > 0))
    return writer.finish(scenes, target)
