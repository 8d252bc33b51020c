"""Ray casting against Blender as one would use it bare: the whole frame, Earth as a textured ball in the scene.

    python tools/cycles_whole_frame.py [frames] [samples] [size]

The bare loop has the target with our materials, the Sun and a ball with the Blue Marble picture (no air, no cloud), and
does nothing per frame but move them and render one picture to OpenEXR: no labels, no sensor, no exact depth. Ray
casting does all of that and writes image, mask and labels; so does our Cycles, which traces the target's window alone.
All take turns frame by frame. Every frame shows Earth. Ratios are of processor time: other jobs do not touch them.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[1] / "out" / "cycles_whole_frame"


def bare(worker_path: str) -> None:
    """Under Blender's interpreter: reads a frame number a line, renders it, answers with a line."""
    from bare_blender import begin

    worker, reply, requests = begin(worker_path, FOLDER)
    import bpy  # pyright: ignore[reportMissingImports]  # Blender's interpreter has it

    scene, earth = bpy.context.scene, _ball(bpy, requests["picture"])
    for line in sys.stdin:
        request = requests["frames"][int(line)]
        worker.set_sun(request["sun"])
        worker.set_camera(scene, request["view"])
        scene.camera.data.clip_end = 1e8
        earth.location, earth.rotation_quaternion = request["earth"]
        scene.cycles.seed, scene.cycles.samples = request["seed"], request["samples"]
        scene.cycles.max_bounces = scene.cycles.diffuse_bounces = scene.cycles.glossy_bounces = request["bounces"]
        scene.render.filepath = str(FOLDER / "bare.exr")
        bpy.ops.render.render(write_still=True)
        reply.write(f"cpu {time.process_time()}\n".encode())
        reply.flush()


def _ball(bpy, picture: str):
    """A ball of Earth's size with a picture on it."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, radius=6.371e6)
    earth = bpy.context.object
    earth.rotation_mode = "QUATERNION"
    bpy.ops.object.shade_smooth()
    material = bpy.data.materials.new("earth")
    material.use_nodes = True
    image = material.node_tree.nodes.new("ShaderNodeTexImage")
    image.image = bpy.data.images.load(picture)
    shader = material.node_tree.nodes["Principled BSDF"]
    material.node_tree.links.new(image.outputs["Color"], shader.inputs["Base Color"])
    earth.data.materials.append(material)
    return earth


def measure(frames: int, samples: int, size: int) -> None:
    """Prints processor seconds per frame of each and their ratios."""
    import numpy as np

    from proxnav.datasets.set.writer import DatasetWriter
    from proxnav.frames import FrameConfig, FrameJob
    from proxnav.missions import load_mission
    from proxnav.missions.scenes import draw_scenes
    from proxnav.rendering.cycles.blender import WORKER, find_blender
    from proxnav.targets.loading import load_target

    mission = load_mission("observation-10-100m")
    mission = replace(mission, looks=replace(mission.looks, earth=1.0))
    scenes = draw_scenes(mission, frames + 2, 0, size)
    write_requests(load_target(mission.target), samples, scenes)
    jobs = [FrameJob(mission.target, FrameConfig(renderer, samples))() for renderer in ("raycast", "cycles")]
    pipe = subprocess.PIPE
    spent = []
    with (
        tempfile.TemporaryDirectory() as folder,
        subprocess.Popen(
            [str(find_blender()), __file__, "--bare", str(WORKER)],
            stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, text=True,
        ) as loop,
    ):  # fmt: skip
        assert loop.stdin is not None
        assert loop.stdout is not None
        writer = DatasetWriter(Path(folder) / "set")
        writer.begin(scenes, load_target(mission.target))
        for k, scene in enumerate(scenes):
            row = []
            for make in jobs:
                frame = make(scene)
                writer.add(scene, frame.image, frame.mask, frame.label)
                row.append(_processor_s(loop.pid))
            loop.stdin.write(f"{k}\n")
            loop.stdin.flush()
            while not (line := loop.stdout.readline()).startswith("cpu "):
                pass
            row.append(float(line.split()[1]))
            spent.append(row)
        loop.stdin.close()
    total = np.array(spent)
    ours = np.diff(np.concatenate([total[1:-1, 1:2], total[2:, :2]], axis=1), axis=1)
    bare_s = np.diff(total[1:, 2])
    seconds = [*ours.mean(axis=0), bare_s.mean()]
    names = ("ray casting, labels and PNG", "our Cycles, window of the target, labels and PNG", "bare bpy, whole frame")
    print(f"{frames} frames of {size} px with Earth in view, {samples} samples; processor seconds per frame:")
    for name, value in zip(names, seconds, strict=True):
        print(f"{name:50s} {value:7.3f}   {value / seconds[0]:5.1f} x ray casting")


def _processor_s(other: int) -> float:
    """Processor time of this process and of its children, `other` not among them (Linux)."""
    total, me = time.process_time(), str(os.getpid())
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if fields[1] == me and stat.parent.name != str(other):
            total += (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return total


def write_requests(target, samples: int, scenes: list) -> None:
    """Leaves in FOLDER what the bare loop needs."""
    import numpy as np

    from proxnav.records import TextureSpec, Window
    from proxnav.rendering.cycles import CyclesConfig, lens
    from proxnav.rendering.cycles.materials import paint_arrays
    from proxnav.rendering.cycles.mesh import mesh_arrays
    from proxnav.rendering.cycles.renderer import OVERSAMPLING, render_request
    from proxnav.rendering.earth.imagery import _basemap_file

    FOLDER.mkdir(parents=True, exist_ok=True)
    paint, maps = paint_arrays(target, TextureSpec())
    mesh = mesh_arrays(target)
    np.savez(FOLDER / "load.npz", allow_pickle=False, **mesh)
    np.savez(FOLDER / "paint.npz", allow_pickle=False, face_part=mesh["face_part"], **maps)
    config, frames = CyclesConfig(samples=samples), []
    for scene in scenes:
        whole = Window(0, 0, scene.camera.width, scene.camera.height)
        pinhole = lens.pinhole_for(scene.camera, whole, OVERSAMPLING)
        assert pinhole is not None
        request = render_request(replace(scene, earth=None), pinhole.camera, 1, target.radius_m, config)[0]
        frames.append(request | {"earth": [scene.earth.r_target_earth_m, scene.earth.q_target_ecef]})
    requests = {"configure": {"threads": 0, "device": "cpu"}, "load": {}, "paint": paint, "frames": frames}
    (FOLDER / "requests.json").write_text(json.dumps(requests | {"picture": str(_basemap_file("bmng.jpg"))}))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--bare"]:
        bare(sys.argv[2])
    else:
        measure(*(int(text) for text in [*sys.argv[1:], *("12", "32", "512")[len(sys.argv) - 1 :]]))
