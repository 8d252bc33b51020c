"""Frames by Cycles: the window that the target covers is path traced, Earth and sky are composed behind it."""

from dataclasses import asdict
from types import TracebackType
from typing import Any

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.records import RenderedFrame, SceneSpec, TextureSpec, Window
from proxnav.rendering.cycles import lens
from proxnav.rendering.cycles.blender import find_blender, worker_command
from proxnav.rendering.cycles.camera import axes_towards, camera_matrix, to_blender
from proxnav.rendering.cycles.config import CyclesConfig
from proxnav.rendering.cycles.materials import paint_arrays
from proxnav.rendering.cycles.mesh import mesh_arrays
from proxnav.rendering.cycles.process import BlenderWorker, WorkerDied
from proxnav.rendering.cycles.wire import Arrays, Message
from proxnav.rendering.earth import background_image, environment_map
from proxnav.rendering.windows import target_window
from proxnav.targets import Target

OVERSAMPLING = 2
"""Pixels per pixel and axis of the undistorted picture from which a distorted lens is resampled."""
_START_S = 300.0  # Blender's first start on a cold disk
_ENVIRONMENT_ROWS = 64  # rows of the equirectangular map of Earth and sky that lights the target
_INDIRECT_CLAMP = 10.0
"""Largest radiance of one path after its first reflection, as a multiple of a sunlit white plate.

It removes the fireflies that the Sun's image in curved foil throws on its neighbours, and their energy with them.
"""


class CyclesRenderer:
    """Renders scenes of one target; a context manager that owns one Blender worker.

    A worker that dies or hangs is replaced and the frame repeated; one that outgrows its memory limit or has drawn its
    number of frames is replaced after it. The frame depends on the scene alone, not on the worker's past.
    """

    def __init__(self, target: Target, config: CyclesConfig | None = None) -> None:
        self.target = target
        self.config = config or CyclesConfig()
        self._command = worker_command(find_blender())
        self._mesh = mesh_arrays(target)
        self._worker: BlenderWorker | None = None
        self._painted: TextureSpec | None = None
        self._drawn = 0

    def __enter__(self) -> "CyclesRenderer":
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Ends the worker; the next frame would start another."""
        if self._worker is not None:
            self._worker.stop()
        self._worker, self._painted, self._drawn = None, None, 0

    def render(self, scene: SceneSpec, window: Window | None = None) -> RenderedFrame:
        """Linear radiance and exact geometry of a scene, over the whole image or a window of it."""
        camera = scene.camera
        window = window or Window(0, 0, camera.width, camera.height)
        inner = target_window(self.target.vertices_m, scene.T_cam_target, camera, window)
        frame = _background(scene, window)
        pinhole = lens.pinhole_for(camera, inner, OVERSAMPLING) if inner.width else None
        if pinhole is not None:
            _lay_over(frame, scene, pinhole, self._shoot(scene, pinhole.camera, pinhole.scale))
        return frame

    def _shoot(self, scene: SceneSpec, view: Camera, scale: int) -> Arrays:
        """What the worker answers for a scene; repeated with a new worker when one dies."""
        header, arrays = render_request(scene, view, scale, self.target.radius_m, self.config)
        deaths = []
        while len(deaths) < self.config.attempts:
            try:
                worker = self._ready(scene.texture)
                results = worker.ask(header, arrays, self.config.timeout_s)[1]
            except WorkerDied as death:
                self.close()
                deaths.append(death)
            except BaseException:  # an interrupted exchange leaves an answer in the pipe
                self.close()
                raise
            else:
                self._drawn += 1
                if worker.memory_mb > self.config.memory_limit_mb or self._drawn >= self.config.frames_per_worker:
                    self.close()
                return results
        raise RuntimeError(f"frame {scene.index} failed {len(deaths)} times: {deaths[-1]}")

    def _ready(self, texture: TextureSpec) -> BlenderWorker:
        """A worker with the target loaded and painted."""
        if self._worker is None:
            self._worker = self._start()
            self._worker.ask(_configuration(self.config), {}, _START_S)
            self._worker.ask({"command": "load"}, self._mesh, _START_S)
        if self._painted != texture:
            header, arrays = paint_arrays(self.target, texture)
            arrays["face_part"] = self._mesh["face_part"]
            self._worker.ask(header, arrays, self.config.timeout_s)
            self._painted = texture
        return self._worker

    def _start(self) -> BlenderWorker:
        try:
            return BlenderWorker.start(self._command, _START_S)
        except (WorkerDied, OSError) as error:
            last = str(error).strip().splitlines()[-1]
            raise InputError(
                f"{self._command[0]} does not run Blender's Python ({last}); set PROXNAV_BLENDER to a Blender 4.5 "
                "executable, or unset it and run `proxnav setup blender`"
            ) from None


def _configuration(config: CyclesConfig) -> dict[str, Any]:
    return {"command": "configure", "threads": config.threads, "device": config.device}


def render_request(scene: SceneSpec, view: Camera, scale: int, radius_m: float, config: CyclesConfig) -> Message:
    """The worker's request for a pinhole view of a scene."""
    range_m = float(np.linalg.norm(scene.t_cam_target_m))
    clip = {"clip_start": max(1e-3, 0.5 * (range_m - radius_m)), "clip_end": 1.1 * (range_m + radius_m)}
    matrix = camera_matrix(scene.T_cam_target).tolist()
    irradiance = [value * scene.sun.visible_fraction for value in scene.sun.irradiance]
    header = {
        "command": "render",
        "view": asdict(to_blender(view)) | clip | {"matrix": matrix},
        "sun": {
            "irradiance": irradiance,
            "diameter_rad": 2.0 * scene.sun.half_angle_rad,
            "axes": axes_towards(np.array(scene.sun.direction_target)).tolist(),
        },
        "samples": -(-config.samples // scale**2),
        "bounces": config.bounces,
        "clamp_indirect": _INDIRECT_CLAMP * max(scene.sun.irradiance) / np.pi,
        "seed": scene.index * 2654435761 % 2**31,  # neighbouring frames draw unrelated numbers
    }
    if scene.earth is None:
        return header, {}
    return header, {"environment": environment_map(scene, _ENVIRONMENT_ROWS)}


def _background(scene: SceneSpec, window: Window) -> RenderedFrame:
    """Earth and sky alone."""
    shape = (window.height, window.width)
    return RenderedFrame(
        window=window,
        radiance=background_image(scene, scene.camera, window),
        depth_m=np.full(shape, np.inf, np.float32),
        part=np.full(shape, -1, np.int16),
        coverage=np.zeros(shape, np.float32),
    )


def _lay_over(frame: RenderedFrame, scene: SceneSpec, pinhole: lens.Pinhole, shot: Arrays) -> None:
    """Puts the rendered target before the background, by coverage."""
    inner, outer, camera = pinhole.window, frame.window, scene.camera
    place = Window(inner.x - outer.x, inner.y - outer.y, inner.width, inner.height).slices
    rgba = lens.through_lens(shot["radiance"], pinhole, camera)
    coverage = np.clip(rgba[..., 3], 0.0, 1.0)
    frame.radiance[place] = rgba[..., :3] + (1.0 - coverage[..., None]) * frame.radiance[place]
    frame.coverage[place] = coverage
    centres = lens.centres_px(inner)
    row, column, inside = lens.nearest(centres, pinhole, camera)
    part = np.where(inside, shot["part"][row, column], -1)
    depth = lens.plane_depth(
        shot["position"][row, column], shot["facet"][row, column], camera.unproject(centres), scene.T_cam_target
    )
    frame.part[place] = part
    frame.depth_m[place] = np.where(part >= 0, depth, np.inf)
