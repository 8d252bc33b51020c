"""What the camera looks at: one scene of a mission as linear radiance, depth and parts."""

from pathlib import Path

import cv2
import numpy as np

from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.records import RenderedFrame
from proxnav.rendering.raycast import RaycastConfig, RaycastRenderer
from proxnav.targets.loading import load_target


def main(out: Path = Path("out/examples"), size: int = 512, seed: int = 0) -> RenderedFrame:
    """Draws a scene at random, renders it, and shows the light tone-mapped for the eye."""
    (scene,) = draw_scenes(load_mission("observation-10-100m"), frames=1, seed=seed, size=size)
    target = load_target(scene.target)
    frame = RaycastRenderer(target, RaycastConfig()).render(scene)

    seen = frame.depth_m[frame.mask]
    print(f"{frame.mask.sum()} pixels of target, range {np.linalg.norm(scene.T_cam_target.t_m):.1f} m")
    if seen.size:
        print(f"depth {seen.min():.2f} to {seen.max():.2f} m")
    parts, counts = np.unique(frame.part[frame.mask], return_counts=True)
    for part, count in sorted(zip(parts, counts, strict=True), key=lambda pair: -pair[1])[:4]:
        print(f"  {target.part_names[part]:<24} {count} px")
    print(f"brightest radiance {frame.radiance.max():.1f} W/(m^2 sr) in one band")

    # radiance is linear: the tone curve below is for looking at, nothing after it measures anything
    bright = np.clip(frame.radiance / max(np.percentile(frame.radiance, 99.9), 1e-9), 0.0, 1.0) ** (1 / 2.2)
    out.mkdir(parents=True, exist_ok=True)
    picture = out / "04_render_raycast.png"
    cv2.imwrite(str(picture), np.round(255 * bright[..., ::-1]).astype(np.uint8))
    print(f"the scene in {picture}")
    return frame


if __name__ == "__main__":
    main()
