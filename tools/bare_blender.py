"""What the bare loops of cycles_overhead.py and cycles_whole_frame.py have in common, under Blender's interpreter."""

import importlib.util
import json
from pathlib import Path


def begin(worker_path: str, folder: Path) -> tuple:
    """(worker module, stream to answer on, requests): `requests.json` of `folder` with its target loaded and painted.

    The scene renders one picture without the passes that our labels need.
    """
    import numpy as np

    spec = importlib.util.spec_from_file_location("worker", worker_path)
    assert spec is not None
    assert spec.loader is not None
    worker = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(worker)
    import bpy  # pyright: ignore[reportMissingImports]  # Blender's interpreter has it

    reply = worker.claim_stdout()
    requests = json.loads((folder / "requests.json").read_text())
    arrays = {name: dict(np.load(folder / f"{name}.npz")) for name in ("load", "paint")}
    for command in ("configure", "load", "paint"):
        getattr(worker, command)(requests[command], arrays.get(command, {}))
    scene = bpy.context.scene
    layer = scene.view_layers[0]
    layer.use_pass_position = layer.use_pass_material_index = False
    layer.aovs.remove(layer.aovs[0])
    scene.cycles.pixel_filter_type = "BOX"
    return worker, reply, requests
