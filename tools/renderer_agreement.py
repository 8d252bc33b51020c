"""Ray casting against Cycles over random scenes: masks, depth, radiance. Prints JSON; draws the pairs with --pictures.

    python tools/renderer_agreement.py --scenes 50 --earth --out benchmarks/results/render

The ratio of radiances is taken pixel by pixel over what both renderers see as target, where the Sun shines on it: more
than `LIT` of a sunlit white plate in Cycles' picture. Pixels on silhouettes count only when both cover them fully.
"""

import argparse
import json
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from proxnav.geometry import Camera
from proxnav.records import RenderedFrame, SceneSpec, TextureSpec
from proxnav.records.scene import SUN_IRRADIANCE
from proxnav.rendering.cycles.config import CyclesConfig
from proxnav.rendering.cycles.renderer import CyclesRenderer
from proxnav.rendering.raycast import RaycastConfig, RaycastRenderer
from proxnav.scenes import RandomSceneConfig, random_scene
from proxnav.storage.files import write_json
from proxnav.targets.loading import load_target

LIT = 0.02
WHITE = float(np.mean(SUN_IRRADIANCE)) / np.pi


def main() -> None:
    """Renders every scene twice and reports each pair and the whole."""
    options = _parse()
    target = load_target("space-rider")
    cast, rows = RaycastRenderer(target, fine_raycast(options)), []
    cycles_config = CyclesConfig(samples=options.samples, bounces=options.bounces)
    with CyclesRenderer(target, cycles_config) as cycles:
        for index in range(options.scenes):
            scene = _scene(index, options)
            start = time.perf_counter()
            a = cast.render(scene)
            between = time.perf_counter()
            b = cycles.render(scene)
            row = {"index": index, "range_m": float(np.linalg.norm(scene.t_cam_target_m)), **compare(a, b)}
            row = {key: value if isinstance(value, bool | int) else float(value) for key, value in row.items()}
            row |= {"raycast_s": between - start, "cycles_s": time.perf_counter() - between}
            print(json.dumps({key: _short(value) for key, value in row.items()}), flush=True)
            rows.append(row)
            if options.pictures:
                _draw(Path(options.pictures) / f"agreement-{index:02d}.png", a, b)
    found = summary(rows)
    print(json.dumps(found, indent=1))
    if options.out:
        name = f"agreement-{'earth' if options.earth else 'black'}{'-default' if options.default else ''}.json"
        record = {
            "options": {key: value for key, value in vars(options).items() if key not in ("out", "pictures")},
            "summary": found,
            "scenes": rows,
        }
        write_json(Path(options.out) / name, record, indent=1)


def fine_raycast(options: argparse.Namespace) -> RaycastConfig:
    """As many rays as Cycles' picture deserves beside it: foil has detail below a pixel, Earthshine has an edge."""
    if options.default:
        return RaycastConfig()
    n = options.rays
    return RaycastConfig(
        samples=n, interior_samples=options.interior, sun_samples=n, bounces=options.bounces, ambient_rays=384,
        environment_rows=64,
    )  # fmt: skip


def compare(a: RenderedFrame, b: RenderedFrame) -> dict[str, Any]:
    """How much two frames of one scene differ; NaN where there is nothing to compare."""
    both, any_ = a.mask & b.mask, a.mask | b.mask
    off_m = np.abs(a.depth_m[both] - b.depth_m[both])
    inside = both & (a.coverage > 0.999) & (b.coverage > 0.999)
    La, Lb = a.radiance[inside].mean(axis=1), b.radiance[inside].mean(axis=1)
    lit = Lb > LIT * WHITE
    dark = ~lit & (Lb > 1e-4 * WHITE)
    return {
        "target_px": int(any_.sum()),
        "mask_iou": both.sum() / any_.sum() if any_.any() else np.nan,
        "part_equal": np.mean(a.part[both] == b.part[both]) if both.any() else np.nan,
        "depth_within_1mm": np.mean(off_m < 1e-3) if both.any() else np.nan,
        "lit_px": int(lit.sum()),
        "lit_median_error": _median(np.abs(La[lit] / Lb[lit] - 1.0)),
        "lit_median_ratio": _median(La[lit] / Lb[lit]),
        "lit_flux_ratio": La[lit].sum() / Lb[lit].sum() if lit.any() else np.nan,
        "dark_median_ratio": _median(La[dark] / Lb[dark]),
        "dark_flux_ratio": La[dark].sum() / Lb[dark].sum() if dark.any() else np.nan,
        "coverage_difference": float(np.abs(a.coverage - b.coverage).sum() / max(b.coverage.sum(), 1.0)),
        "background_equal": bool((a.radiance == b.radiance)[(a.coverage == 0) & (b.coverage == 0)].all()),
    }


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """The means over scenes weighted as the claims are: by pixel for depth and masks, by scene for radiance."""
    seen = [row for row in rows if row["target_px"] > 0]
    pixels = np.array([row["target_px"] for row in seen], dtype=float)
    lit = [row for row in seen if row["lit_px"] > 50]

    def weighted(key: str) -> float:
        return float(np.average([row[key] for row in seen], weights=pixels))

    return {
        "scenes": len(seen),
        "lit_scenes": len(lit),
        "mask_iou": weighted("mask_iou"),
        "mask_iou_least": min(row["mask_iou"] for row in seen),
        "depth_within_1mm": weighted("depth_within_1mm"),
        "lit_median_error": _median(np.array([row["lit_median_error"] for row in lit])),
        "lit_median_error_worst": max((row["lit_median_error"] for row in lit), default=np.nan),
        "lit_median_ratio": _median(np.array([row["lit_median_ratio"] for row in lit])),
        "lit_flux_ratio": _median(np.array([row["lit_flux_ratio"] for row in lit])),
        "dark_flux_ratio": _median(np.array([row["dark_flux_ratio"] for row in seen])),
        "background_equal": all(row["background_equal"] for row in seen),
        "speed_ratio": float(sum(row["cycles_s"] for row in seen) / sum(row["raycast_s"] for row in seen)),
    }


def _scene(index: int, options: argparse.Namespace) -> SceneSpec:
    size = options.size
    camera = Camera(size, size, 1.374 * size, 1.374 * size, size / 2, size / 2)  # 40 deg
    config = RandomSceneConfig(earth=options.earth, texture_strength=(0.0, options.texture))
    scene = random_scene(index, options.seed, config, "space-rider", camera)
    if options.texture > 0.0:
        return scene
    return replace(scene, texture=TextureSpec())


def _draw(path: Path, a: RenderedFrame, b: RenderedFrame) -> None:
    """Both pictures and their ratio, from half (blue) to double (red)."""
    pair = [np.clip(frame.radiance / WHITE, 0.0, 1.0) ** (1 / 2.2) * 255 for frame in (a, b)]
    with np.errstate(all="ignore"):
        ratio = np.log2((a.radiance.mean(axis=2) + 1e-3) / (b.radiance.mean(axis=2) + 1e-3))
    scaled = (np.clip(ratio, -1.0, 1.0) * 127 + 128).astype(np.uint8)
    picture = np.concatenate([image.astype(np.uint8)[..., ::-1] for image in pair], axis=1)
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), np.concatenate([picture, cv2.applyColorMap(scaled, cv2.COLORMAP_TWILIGHT_SHIFTED)], axis=1))


def _median(values: np.ndarray) -> float:
    values = values[np.isfinite(values)]
    return float(np.median(values)) if len(values) else np.nan


def _short(value: float) -> float:
    return round(float(value), 5) if isinstance(value, float | np.floating) else value


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=50)
    parser.add_argument("--size", type=int, default=256, help="pixels")
    parser.add_argument("--samples", type=int, default=256, help="Cycles' paths per pixel")
    parser.add_argument("--rays", type=int, default=64, help="ray casting's rays per pixel with an edge")
    parser.add_argument("--interior", type=int, default=64, help="ray casting's rays per interior pixel")
    parser.add_argument("--default", action="store_true", help="ray casting as `proxnav render` draws")
    parser.add_argument("--bounces", type=int, default=3)
    parser.add_argument("--texture", type=float, default=0.0, help="most texture strength, 0 to 1")
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--earth", action="store_true")
    parser.add_argument("--pictures", help="folder for the pairs")
    parser.add_argument("--out", help="folder for the figures as JSON")
    return parser.parse_args()


if __name__ == "__main__":
    main()
