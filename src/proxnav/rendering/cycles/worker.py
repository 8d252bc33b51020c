"""The Cycles worker: a script for Blender's own interpreter that renders frames asked for over a pipe.

Runs as `python worker.py` where bpy is installed, or as `blender --background --python worker.py`. It needs bpy,
Blender's numpy and wire.py, which lies beside it, and never imports proxnav: bpy is GPL-3, so this file runs in a
process of its own and exchanges plain data only. As a script that calls bpy it may be distributed under the terms of
the GPL-3 as well as under the package's licence.

World axes are the target's axes. Commands: `configure`, `load`, `paint`, `render`.
"""

import contextlib
import ctypes
import os
import shutil
import struct
import sys
import traceback
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

sys.path.append(str(Path(__file__).parent))  # `blender --python` leaves the script's own folder out
from wire import MAGIC, read_message, write_message

CENTRE_FILTER_PX = 0.01  # the narrowest filter Cycles takes: samples within 0.005 px of the pixel's centre


def claim_stdout():
    """The reply channel; everything that Blender prints goes to stderr from now on."""
    reply = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    reply.write(MAGIC)
    reply.flush()
    return reply


def configure(header, arrays):
    """Empties the scene and sets all that stays the same from frame to frame."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.use_persistent_data = True
    render.film_transparent = True
    render.resolution_percentage = 100
    render.dither_intensity = 0.0
    render.use_compositing = render.use_sequencer = False
    render.threads_mode = "FIXED" if header["threads"] else "AUTO"
    if header["threads"]:
        render.threads = header["threads"]
    output = render.image_settings
    output.file_format, output.color_depth, output.exr_codec = "OPEN_EXR_MULTILAYER", "32", "NONE"
    scene.view_settings.view_transform = "Raw"
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_auto_tile = False
    cycles.sampling_pattern = "TABULATED_SOBOL"
    cycles.light_sampling_threshold = 0.0
    cycles.use_light_tree = False
    cycles.sample_clamp_direct = 0.0
    cycles.transmission_bounces = cycles.transparent_max_bounces = cycles.volume_bounces = 0
    make_camera(scene)
    make_sun(scene)
    make_world(scene)
    layer = scene.view_layers[0]
    layer.use_pass_z = False
    layer.use_pass_position = layer.use_pass_material_index = True
    layer.aovs.add().name = "facet"
    return {"device": choose_device(scene, header["device"]), "blender": bpy.app.version_string}, {}


def choose_device(scene, wanted):
    """Uses the GPUs that Cycles finds when `wanted` is auto; returns the kind of device in use."""
    scene.cycles.device = "CPU"
    if wanted == "cpu":
        return "CPU"
    preferences = bpy.context.preferences.addons["cycles"].preferences
    for kind in ("OPTIX", "CUDA", "HIP", "METAL", "ONEAPI"):
        try:
            preferences.compute_device_type = kind
            preferences.get_devices()
        except TypeError:  # this build of Blender does not know the kind
            continue
        if any(device.type == kind for device in preferences.devices):
            for device in preferences.devices:
                device.use = device.type == kind
            scene.cycles.device = "GPU"
            return kind
    return "CPU"


def make_camera(scene):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "HORIZONTAL"
    scene.camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(scene.camera)


def make_sun(scene):
    light = bpy.data.lights.new("sun", "SUN")
    light.cycles.use_multiple_importance_sampling = True
    scene.collection.objects.link(bpy.data.objects.new("sun", light))


def make_world(scene):
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.cycles.sampling_method = "MANUAL"


def load(header, arrays):
    """Brings in the target: vertices with one normal each, triangles, parts, texture coordinates [m]."""
    vertices, faces = arrays["vertices"], arrays["faces"]
    mesh = bpy.data.meshes.new("target")
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", vertices.ravel())
    mesh.loops.add(faces.size)
    mesh.loops.foreach_set("vertex_index", faces.ravel())
    mesh.polygons.add(len(faces))
    mesh.polygons.foreach_set("loop_start", np.arange(0, faces.size, 3, dtype=np.int32))
    mesh.polygons.foreach_set("material_index", arrays["face_part"])
    mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), dtype=bool))
    mesh.uv_layers.new(name="surface_m").uv.foreach_set("vector", arrays["corner_uv"].ravel())
    mesh.update(calc_edges=True)
    mesh.attributes.new("custom_normal", "FLOAT_VECTOR", "POINT").data.foreach_set("vector", arrays["normals"].ravel())
    target = bpy.data.objects.new("target", mesh)
    target.cycles.shadow_terminator_geometry_offset = 0.0
    bpy.context.scene.collection.objects.link(target)
    return {}, {}


def paint(header, arrays):
    """Replaces all materials; `parts` of the header lists them, maps are arrays named `albedo0`, `surface0`, ..."""
    forget()
    mesh = bpy.data.objects["target"].data
    old = [*bpy.data.materials, *(image for image in bpy.data.images if image.name.startswith("part"))]
    mesh.materials.clear()
    for index, part in enumerate(header["parts"]):
        maps = {key: arrays.get(f"{key}{index}") for key in ("albedo", "surface", "normal")}
        material = make_material(index, part, maps)
        material.pass_index = index + 1  # 0 is "no target"
        mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", arrays["face_part"])
    bpy.data.batch_remove(old)
    give_back_memory()
    return {}, {}


def give_back_memory():
    """Hands freed pages back to the system: between textures of many sizes glibc's heap grows by fragments for good."""
    with contextlib.suppress(OSError, AttributeError):  # another C library has no such call
        ctypes.CDLL(None).malloc_trim(0)


def forget():
    """Frees what Cycles keeps between frames.

    It would keep the images of removed materials for good, and would take a new image for an old one where it happens
    to lie at the same address.
    """
    bpy.context.scene.render.use_persistent_data = False
    bpy.context.scene.render.use_persistent_data = True


def make_material(index, part, maps):
    """The BSDF of targets/material.py: Lambert under a dielectric GGX coat, mixed with a coloured GGX metal."""
    material = bpy.data.materials.new(f"part{index}")
    material.use_nodes = True
    material.cycles.use_bump_map_correction = False  # it darkens tilted bumps beyond the cosine
    tree = material.node_tree
    tree.nodes.clear()
    link = tree.links.new
    uv = add_uv(tree, part["tile_m"])
    albedo = add_map(tree, uv, maps["albedo"], f"part{index} albedo")
    split = tree.nodes.new("ShaderNodeSeparateColor")
    link(add_map(tree, uv, maps["surface"], f"part{index} surface"), split.inputs[0])
    metallic, roughness = split.outputs[0], split.outputs[1]
    normal = add_normal(tree, uv, maps["normal"], f"part{index} normal")
    fresnel = add(tree, "ShaderNodeFresnel", IOR=part["ior"], Normal=normal)
    diffuse = add(tree, "ShaderNodeBsdfDiffuse", Color=albedo, Normal=normal)
    coat = add(tree, "ShaderNodeBsdfAnisotropic", Roughness=roughness, Normal=normal, Color=(1.0, 1.0, 1.0, 1.0))
    metal = add(tree, "ShaderNodeBsdfAnisotropic", Roughness=roughness, Normal=normal, Color=albedo)
    coat.distribution = metal.distribution = "GGX"
    surface = mix(tree, metallic, mix(tree, fresnel.outputs[0], diffuse, coat), metal)
    if max(part["emission"]) > 0.0:
        lamp = add(tree, "ShaderNodeEmission", Color=(*part["emission"], 1.0), Strength=1.0)
        surface = add(tree, "ShaderNodeAddShader", **{"0": surface.outputs[0], "1": lamp.outputs[0]})
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    link(surface.outputs[0], output.inputs["Surface"])
    facet = tree.nodes.new("ShaderNodeOutputAOV")
    facet.aov_name = "facet"
    link(tree.nodes.new("ShaderNodeNewGeometry").outputs["True Normal"], facet.inputs["Color"])
    return material


def add(tree, kind, **inputs):
    """A node with its inputs linked (sockets) or set (values); None leaves the default."""
    node = tree.nodes.new(kind)
    for name, value in inputs.items():
        socket = node.inputs[int(name) if name.isdigit() else name]
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, socket)
        elif value is not None:
            socket.default_value = value
    return node


def mix(tree, share, first, second):
    """(1 - share) first + share second."""
    return add(tree, "ShaderNodeMixShader", **{"0": share, "1": first.outputs[0], "2": second.outputs[0]})


def add_uv(tree, tile_m):
    source = tree.nodes.new("ShaderNodeUVMap")
    source.uv_map = "surface_m"
    scale = (1.0 / tile_m, 1.0 / tile_m, 1.0)
    return add(tree, "ShaderNodeMapping", Vector=source.outputs[0], Scale=scale).outputs[0]


def add_map(tree, uv, pixels, name):
    """The colour socket of a repeated linear texture, or of a constant when the map is one texel."""
    if pixels.shape[:2] == (1, 1):
        constant = tree.nodes.new("ShaderNodeRGB")
        constant.outputs[0].default_value = (*(float(value) for value in pixels[0, 0]), 1.0)
        return constant.outputs[0]
    node = add(tree, "ShaderNodeTexImage", Vector=uv)
    node.image = make_image(name, pixels)
    return node.outputs[0]


def add_normal(tree, uv, pixels, name):
    """The socket of a tangent-space normal map that holds (n + 1) / 2, or None without one."""
    if pixels is None:
        return None
    node = add(tree, "ShaderNodeNormalMap", Color=add_map(tree, uv, pixels, name))
    node.uv_map = "surface_m"
    return node.outputs[0]


def make_image(name, pixels):
    """A float image of raw numbers; row 0 lies at v = 0."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.new(name, width, height, alpha=False, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    rgba = np.ones((height, width, 4), dtype=np.float32)
    rgba[..., :3] = pixels
    image.pixels.foreach_set(rgba.ravel())
    image.update()
    return image


def set_sun(sun):
    """The Sun's direction (unit, target axes), irradiance [W/m^2] in three bands, and angular diameter [rad]."""
    lamp = bpy.data.objects["sun"]
    peak = max(sun["irradiance"])
    lamp.hide_render = peak <= 0.0
    lamp.data.energy = peak
    lamp.data.color = [value / peak for value in sun["irradiance"]] if peak > 0.0 else (1.0, 1.0, 1.0)
    lamp.data.angle = sun["diameter_rad"]
    lamp.matrix_basis = Matrix([[*row, 0.0] for row in sun["axes"]] + [[0.0, 0.0, 0.0, 1.0]])


def set_world(environment):
    """Radiance from all around: (rows, 2 rows, 3), row 0 at +z, azimuth from -pi eastwards. None is black."""
    tree = bpy.context.scene.world.node_tree
    tree.nodes.clear()
    old = [image for image in bpy.data.images if image.name.startswith("environment")]
    background = add(tree, "ShaderNodeBackground", Color=(0.0, 0.0, 0.0, 1.0))
    if environment is not None:
        node = tree.nodes.new("ShaderNodeTexEnvironment")
        node.image = make_image("environment", environment[::-1, ::-1])  # Blender's azimuth runs the other way
        tree.links.new(node.outputs[0], background.inputs["Color"])
        bpy.context.scene.world.cycles.sample_map_resolution = environment.shape[1]
    output = tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    bpy.data.batch_remove(old)  # last: Cycles tells images apart by their addresses (see `forget`)


def set_camera(scene, view):
    camera, render = scene.camera, scene.render
    render.resolution_x, render.resolution_y = view["width"], view["height"]
    render.pixel_aspect_x, render.pixel_aspect_y = view["aspect_x"], view["aspect_y"]
    for name in ("sensor_width", "lens", "shift_x", "shift_y", "clip_start", "clip_end"):
        setattr(camera.data, name, view[name])
    camera.matrix_basis = Matrix(view["matrix"])


def render(header, arrays):
    """One frame: `radiance` (h, w, 4) premultiplied with coverage, and what each pixel's centre sees."""
    scene = bpy.context.scene
    set_sun(header["sun"])
    set_world(arrays.get("environment"))
    set_camera(scene, header["view"])
    scene.cycles.seed = header["seed"]
    scene.cycles.sample_clamp_indirect = header["clamp_indirect"]
    path = Path(header["folder"]) / "frame.exr"
    light = shoot(scene, path, header["samples"], "BOX", 1.0, header["bounces"])
    facts = shoot(scene, path, 1, "GAUSSIAN", CENTRE_FILTER_PX, 0)
    return {}, {
        "radiance": np.stack([light[f"Combined.{c}"] for c in "RGBA"], axis=-1),
        "position": np.stack([facts[f"Position.{c}"] for c in "XYZ"], axis=-1),
        "facet": np.stack([facts[f"facet.{c}"] for c in "RGB"], axis=-1),
        "part": facts["IndexMA.X"].astype(np.int16) - np.int16(1),
    }


def shoot(scene, path, samples, pixel_filter, width_px, bounces):
    """Renders once and reads all channels back; a box filter integrates over the pixel's area as a detector does."""
    scene.cycles.samples = samples
    scene.cycles.pixel_filter_type = pixel_filter
    scene.cycles.filter_width = width_px
    scene.cycles.max_bounces = scene.cycles.diffuse_bounces = scene.cycles.glossy_bounces = bounces
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    channels = read_exr(path)
    path.unlink()
    return channels


def read_exr(path):
    """Channels by name (h, w) of an uncompressed scan-line OpenEXR file of 32-bit floats.

    https://openexr.com/en/latest/OpenEXRFileLayout.html
    """
    data = path.read_bytes()
    names, window, position = [], None, 8
    while data[position] != 0:
        name, position = c_string(data, position)
        _kind, position = c_string(data, position)
        size = struct.unpack_from("<i", data, position)[0]
        position += 4
        if name == "channels":
            names = channel_names(data, position)
        if name == "dataWindow":
            window = struct.unpack_from("<4i", data, position)
        position += size
    width, height = window[2] - window[0] + 1, window[3] - window[1] + 1
    after_offsets = position + 1 + 8 * height
    rows = np.frombuffer(data, dtype="<f4", offset=after_offsets).reshape(height, 2 + len(names) * width)
    planes = rows[:, 2:].reshape(height, len(names), width)
    return {name.split(".", 1)[-1]: planes[:, i] for i, name in enumerate(names)}


def c_string(data, position):
    end = data.index(b"\0", position)
    return data[position:end].decode(), end + 1


def channel_names(data, position):
    names = []
    while data[position] != 0:
        name, position = c_string(data, position)
        position += 16  # pixel type, linearity, sampling
        names.append(name)
    return names


def memory_mb():
    """Resident memory of this process [MiB]; 0 where the system does not tell."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 2**20
    except OSError:
        return 0.0


def main():
    reply = claim_stdout()
    commands = {"configure": configure, "load": load, "paint": paint, "render": render}
    folder = None
    with contextlib.suppress(EOFError):  # the other end is gone
        while True:
            header, arrays = read_message(sys.stdin.buffer)
            folder = header["folder"]
            try:
                answer, results = commands[header["command"]](header, arrays)
                answer["status"] = "ok"
            except Exception:
                answer, results = {"status": "error", "message": traceback.format_exc()}, {}
            write_message(reply, answer | {"memory_mb": memory_mb()}, results)
    if folder is not None:  # nobody else can remove it
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
