"""What Cycles costs through us, against a bare bpy loop over the same scenes with the same samples and window.

    python tools/cycles_overhead.py [frames] [samples]

The bare loop has the target, materials and light in the same Blender and does nothing per frame but move the camera
and the Sun, render the picture once and write it as OpenEXR. Ours adds what makes it a frame: the pass of exact depths
and part ids, the pipe, the composition, the watch over the worker. The two take turns frame by frame, so that other
load on the machine meets both. Earth is left out: a bare loop has none.
"""

import json
import subprocess
import sys
import time
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[1] / "out" / "cycles_overhead"


def bare(worker_path: str) -> None:
    """Under Blender's interpreter: reads a frame number a line, renders it, answers with a line."""
    from bare_blender import begin

    worker, reply, requests = begin(worker_path, FOLDER)
    import bpy  # pyright: ignore[reportMissingImports]  # Blender's interpreter has it

    scene = bpy.context.scene
    for line in sys.stdin:
        request = requests["frames"][int(line)]
        worker.set_sun(request["sun"])
        worker.set_camera(scene, request["view"])
        scene.cycles.seed, scene.cycles.samples = request["seed"], request["samples"]
        scene.cycles.sample_clamp_indirect = request["clamp_indirect"]
        scene.cycles.max_bounces = scene.cycles.diffuse_bounces = scene.cycles.glossy_bounces = request["bounces"]
        scene.render.filepath = str(FOLDER / "bare.exr")
        bpy.ops.render.render(write_still=True)
        reply.write(b"done\n")
        reply.flush()


def measure(frames: int, samples: int) -> None:
    """Prints seconds per frame of both and their ratio."""
    import numpy as np

    from proxnav.rendering.cycles import CyclesConfig
    from proxnav.rendering.cycles.blender import WORKER, find_blender
    from proxnav.rendering.cycles.renderer import CyclesRenderer
    from proxnav.targets.loading import load_target

    target, config = load_target("space-rider"), CyclesConfig(samples=samples, device="cpu")
    scenes = draw_scenes(frames)
    write_requests(target, config, scenes)
    command = [str(find_blender()), __file__, "--bare", str(WORKER)]
    pipe = subprocess.PIPE
    times = []
    with (
        subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, text=True) as loop,
        CyclesRenderer(target, config) as renderer,
    ):
        assert loop.stdin is not None
        assert loop.stdout is not None
        for index, scene in enumerate([scenes[0], *scenes]):  # the first warms both up
            began = time.perf_counter()
            renderer.render(scene)
            ours = time.perf_counter()
            loop.stdin.write(f"{max(index - 1, 0)}\n")
            loop.stdin.flush()
            while loop.stdout.readline() != "done\n":
                pass
            times.append((ours - began, time.perf_counter() - ours))
        loop.stdin.close()
    ours, theirs = np.array(times[1:]).T
    print(f"{frames} frames of 1024 px, {samples} samples, 15-100 m, window of the target")
    print(f"bare bpy loop {theirs.mean():.3f} s/frame, proxnav {ours.mean():.3f} s/frame")
    print(f"ratio of the sums {ours.sum() / theirs.sum():.3f}, median of the ratios {np.median(ours / theirs):.3f}")


def draw_scenes(count: int) -> list:
    """Random attitudes at 15 to 100 m, sunlit from behind the camera's left shoulder."""
    import numpy as np

    from proxnav.geometry import Camera, Pose, quaternion
    from proxnav.records import SceneSpec, SunSpec

    camera, rng, scenes = Camera(1024, 1024, 1407.0, 1407.0, 512.0, 512.0), np.random.default_rng(7), []
    for index in range(count):
        q = quaternion.random(rng, 1)[0]
        T = Pose.from_wxyz("cam", "target", q, [0.0, 0.0, rng.uniform(15.0, 100.0)])
        sun = T.R.T @ np.array([-0.6, -0.3, -0.7])
        sun = SunSpec(tuple((sun / np.linalg.norm(sun)).tolist()))
        scenes.append(SceneSpec(index, "space-rider", camera, tuple(q.tolist()), tuple(T.t_m.tolist()), sun))
    return scenes


def write_requests(target, config, scenes: list) -> None:
    """Leaves in FOLDER what our worker would be sent, for the bare loop."""
    import numpy as np

    from proxnav.records import TextureSpec, Window
    from proxnav.rendering.cycles import lens
    from proxnav.rendering.cycles.materials import paint_arrays
    from proxnav.rendering.cycles.mesh import mesh_arrays
    from proxnav.rendering.cycles.renderer import render_request
    from proxnav.rendering.windows import target_window

    FOLDER.mkdir(parents=True, exist_ok=True)
    paint, maps = paint_arrays(target, TextureSpec())
    mesh = mesh_arrays(target)
    np.savez(FOLDER / "load.npz", allow_pickle=False, **mesh)
    np.savez(FOLDER / "paint.npz", allow_pickle=False, face_part=mesh["face_part"], **maps)
    frames = []
    for scene in scenes:
        window = target_window(target.vertices_m, scene.T_cam_target, scene.camera, Window(0, 0, 1024, 1024))
        pinhole = lens.pinhole_for(scene.camera, window, config.oversampling)
        assert pinhole is not None
        frames.append(render_request(scene, pinhole.camera, 1, target.radius_m, config)[0])
    requests = {"configure": {"threads": 0, "device": "cpu"}, "load": {}, "paint": paint, "frames": frames}
    (FOLDER / "requests.json").write_text(json.dumps(requests))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--bare"]:
        bare(sys.argv[2])
    else:
        measure(*(int(text) for text in [*sys.argv[1:], *("24", "32")[len(sys.argv) - 1 :]]))
