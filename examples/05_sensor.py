"""What the detector reads: the same light through three cameras and at three exposures."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.rendering.raycast import RaycastConfig, RaycastRenderer
from proxnav.sensor import expose
from proxnav.sensor.presets import IDEAL, SPEED_CLASS, scaled_noise
from proxnav.targets.loading import load_target


def main(out: Path = Path("out/examples"), size: int = 384, seed: int = 0) -> list[np.ndarray]:
    """Renders once and exposes often: noise, gain and saturation belong to the sensor, not to the scene."""
    (scene,) = draw_scenes(load_mission("observation-10-100m"), frames=1, seed=seed, size=size)
    light = RaycastRenderer(load_target(scene.target), RaycastConfig()).render(scene)

    sensors = {
        "ideal": replace(IDEAL, bits=8),
        "speed-class": SPEED_CLASS,
        "ten times the noise": scaled_noise(SPEED_CLASS, 10.0),
    }
    images = []
    for name, sensor in sensors.items():
        seen = replace(scene, sensor=sensor)
        chosen = expose(light, seen).exposure_s  # the sensor's own automatic exposure
        for factor in (0.25, 1.0, 4.0):
            read = expose(light, seen, exposure_s=chosen * factor)
            images.append(read.image)
            print(
                f"{name:<19} {1e3 * read.exposure_s:8.3f} ms  target {read.image[light.mask].mean():6.1f} DN", end="  "
            )
            print(f"saturated {100 * read.saturated_share:5.2f} %")

    out.mkdir(parents=True, exist_ok=True)
    picture = out / "05_sensor.png"
    cv2.imwrite(str(picture), np.vstack([np.hstack(images[i : i + 3]) for i in (0, 3, 6)]))
    print(f"rows: sensors, columns: exposures, in {picture}")
    return images


if __name__ == "__main__":
    main()
