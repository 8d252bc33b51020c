"""A replay as a Rerun recording: one time line, camera axes told explicitly (x right, y down, z forward).

world/target                 mesh, keypoints              world/truth/camera      frustum, image, keypoints
world/estimate/camera        where the run puts it        world/estimate/sigma    3-sigma ellipsoid of its position
world/truth/path, ...        trajectory                   errors/..., status      error and 3 sigma per axis, status
"""

import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry import Pose, quaternion
from proxnav.geometry.types import QuatWxyz
from proxnav.images.codecs import encode_jpeg, read_image
from proxnav.images.tones import as_8_bit
from proxnav.storage.files import replacing
from proxnav.viewing.replay.replay import Placement, Replay, ReplayStep

TIMELINE = "t"
_TRUE, _FOUND, _ESTIMATE, _QUIET = (90, 220, 90), (255, 200, 40), (255, 140, 40), (150, 150, 150)
JPEG_QUALITY = 85
_ERROR_COLOURS = ((235, 70, 70), (70, 200, 70), (80, 130, 255))


def save_rerun(replay: Replay, path: Path) -> None:
    """Writes the recording, with its layout, to an .rrd file; whole or not at all."""
    rr = rerun_module()
    with replacing(path) as part:
        with rr.RecordingStream("proxnav", recording_id=replay.title) as recording:
            recording.save(part, default_blueprint=_layout(replay))
            log_replay(replay, recording)
        recording.flush()
        recording.disconnect()


def open_rerun(replay: Replay) -> None:
    """Opens the viewer and plays into it; InputError where there is no display."""
    rr = rerun_module()
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise InputError("this machine has no display: give --save FILE.rrd and open that file elsewhere with 'rerun'")
    with rr.RecordingStream("proxnav", recording_id=replay.title) as recording:
        recording.spawn(default_blueprint=_layout(replay))
        log_replay(replay, recording)
    recording.flush()


def log_replay(replay: Replay, recording: Any) -> None:
    """Everything, step by step, on one time line."""
    recording.set_log_time_enabled(False)
    recording.set_log_tick_enabled(False)
    _log_fixed(replay, recording)
    for step in replay.steps:
        recording.set_time(TIMELINE, duration=step.t)
        _log_step(replay, step, recording)


def _log_fixed(replay: Replay, recording: Any) -> None:
    rr, camera = rerun_module(), replay.camera
    axes = rr.ViewCoordinates.FRD if replay.world == "target" else rr.ViewCoordinates.RIGHT_HAND_X_UP
    recording.log("world", axes, static=True)
    recording.log("world/target/axes", _triad(float(_size(replay)) / 4.0), static=True)
    recording.log("world/target/keypoints", rr.Points3D(replay.keypoints_m, colors=_FOUND, radii=0.04), static=True)
    if replay.target is not None:
        recording.log("world/target/mesh", _mesh(replay), static=True)
    for kind, colour in (("truth", _TRUE), ("estimate", _ESTIMATE)):
        pinhole = rr.Pinhole(
            image_from_camera=camera.K, resolution=[camera.width, camera.height],
            camera_xyz=rr.ViewCoordinates.RDF, image_plane_distance=0.5 * _size(replay), color=colour,
        )  # fmt: skip
        recording.log(f"world/{kind}/camera/image", pinhole, static=True)
        recording.log(f"world/{kind}/path", _path(replay, kind, colour), static=True)
    for group, names, unit in (("position", replay.axes[:3], "m"), ("attitude", replay.axes[3:], "deg")):
        for name, colour in zip(names, _ERROR_COLOURS, strict=True):
            lines = rr.SeriesLines(colors=colour, names=f"{name} [{unit}]", widths=2.0)
            place = f"errors/{group}/{entity_name(name)}"
            recording.log(place, lines, static=True)
            for side in ("above", "below"):
                bound = rr.SeriesLines(colors=(*colour, 110), names=f"3 sigma, {name}", widths=1.0)
                recording.log(f"{place}/3_sigma_{side}", bound, static=True)


def _log_step(replay: Replay, step: ReplayStep, recording: Any) -> None:
    rr = rerun_module()
    for kind, view in (("truth", step.truth), ("estimate", step.estimate)):
        moved = rr.Clear(recursive=False) if view is None else _transform(view.T_world_cam)
        recording.log(f"world/{kind}/camera", moved)
    shown = step.truth or step.estimate
    if shown is not None:
        recording.log("world/target", _transform(shown.T_world_target))
    _log_image(replay, step, shown, recording)
    _log_ellipsoid(step, recording)
    _log_errors(replay, step, recording)
    recording.log("status", rr.TextLog(f"{step.label}: {step.status}", level="INFO" if step.estimate else "WARN"))


def _log_image(replay: Replay, step: ReplayStep, shown: Placement | None, recording: Any) -> None:
    rr, place = rerun_module(), "world/truth/camera/image"
    if step.image is not None and step.image.is_file():
        contents = encode_jpeg(as_8_bit(read_image(step.image)), JPEG_QUALITY)
        recording.log(place, rr.EncodedImage(contents=contents, media_type="image/jpeg"))
    if shown is not None:
        true = replay.camera.project(shown.T_cam_target @ replay.keypoints_m)
        recording.log(f"{place}/true", rr.Points2D(_finite(true), colors=_TRUE, radii=rr.Radius.ui_points(2.5)))
    found = np.zeros((0, 2)) if step.pixels is None else _finite(step.pixels)
    recording.log(f"{place}/found", rr.Points2D(found, colors=_FOUND, radii=rr.Radius.ui_points(2.5)))
    recording.log(f"{place}/found_3_sigma", rr.LineStrips2D(ellipses(step), colors=_FOUND))


def _log_ellipsoid(step: ReplayStep, recording: Any) -> None:
    rr = rerun_module()
    if step.estimate is None or step.covariance_m2 is None or not np.isfinite(step.covariance_m2).all():
        recording.log("world/estimate/sigma", rr.Clear(recursive=False))
        return
    variances, R = np.linalg.eigh(step.covariance_m2)
    R = R * np.sign(np.linalg.det(R))
    shape = rr.Ellipsoids3D(
        half_sizes=[3.0 * np.sqrt(np.maximum(variances, 0.0))], centers=[step.estimate.T_world_cam.t_m],
        quaternions=[_xyzw(quaternion.from_matrix(R))], colors=[_ESTIMATE], fill_mode="majorwireframe",
    )  # fmt: skip
    recording.log("world/estimate/sigma", shape)


def _log_errors(replay: Replay, step: ReplayStep, recording: Any) -> None:
    rr = rerun_module()
    for k, name in enumerate(replay.axes):
        group, scale = ("position", 1.0) if k < 3 else ("attitude", 180.0 / np.pi)
        place = f"errors/{group}/{entity_name(name)}"
        if step.errors is not None:
            recording.log(place, rr.Scalars(float(step.errors[k]) * scale))
        if step.sigmas is not None:
            bound = 3.0 * float(step.sigmas[k]) * scale
            recording.log(f"{place}/3_sigma_above", rr.Scalars(bound))
            recording.log(f"{place}/3_sigma_below", rr.Scalars(-bound))


def ellipses(step: ReplayStep, points: int = 24) -> list[Float[np.ndarray, "points 2"]]:
    """3-sigma ellipses of the found keypoints, each a closed line [px]."""
    if step.pixels is None or step.covariances_px2 is None:
        return []
    circle = np.linspace(0.0, 2.0 * np.pi, points + 1)
    unit_circle = np.stack([np.cos(circle), np.sin(circle)])
    lines = []
    for pixel, covariance in zip(step.pixels, step.covariances_px2, strict=True):
        if np.isfinite(pixel).all() and np.isfinite(covariance).all():
            variances, axes = np.linalg.eigh(covariance)
            half = 3.0 * np.sqrt(np.maximum(variances, 0.0))
            lines.append(pixel + (axes @ (half[:, None] * unit_circle)).T)
    return lines


def entity_name(name: str) -> str:
    """The name of an error's component as part of an entity path."""
    return name.replace(" ", "_")


def _path(replay: Replay, kind: str, colour: tuple[int, int, int]) -> Any:
    """All places of the camera: a line where they follow one another in time, dots otherwise."""
    rr = rerun_module()
    views = [step.truth if kind == "truth" else step.estimate for step in replay.steps]
    places = np.array([view.T_world_cam.t_m for view in views if view is not None]).reshape(-1, 3)
    if replay.is_sequence:
        return rr.LineStrips3D([places] if len(places) > 1 else [], colors=colour)
    return rr.Points3D(places, colors=colour, radii=rr.Radius.ui_points(2.0))


def _mesh(replay: Replay) -> Any:
    """Triangles with flat colours of their parts; corners are not shared, so that parts keep apart."""
    target = replay.target
    assert target is not None
    albedo = np.array([material.albedo for material in target.materials])[target.face_part]
    shade = np.round(255.0 * np.clip(albedo, 0.0, 1.0) ** (1.0 / 2.2)).astype(np.uint8)
    return rerun_module().Mesh3D(
        vertex_positions=target.vertices_m[target.faces].reshape(-1, 3).astype(np.float32),
        triangle_indices=np.arange(3 * len(target.faces), dtype=np.uint32).reshape(-1, 3),
        vertex_normals=target.corner_normals.reshape(-1, 3).astype(np.float32),
        vertex_colors=np.repeat(shade, 3, axis=0),
    )


def _layout(replay: Replay) -> Any:
    """The scene on the left, image and errors on the right."""
    import rerun.blueprint as rrb

    world = "target frame" if replay.world == "target" else "RIC frame"
    right = rrb.Vertical(
        rrb.Spatial2DView(origin="world/truth/camera/image", name="image"),
        rrb.TimeSeriesView(origin="errors/position", name="position error [m]"),
        rrb.TimeSeriesView(origin="errors/attitude", name="attitude error [deg]"),
        row_shares=[2, 1, 1],
    )
    scene = rrb.Spatial3DView(origin="world", name=f"scene, {world}")
    return rrb.Blueprint(
        rrb.Horizontal(rrb.Vertical(scene, rrb.TextLogView(origin="status", name="status"), row_shares=[4, 1]), right),
        rrb.TimePanel(state="collapsed"),
    )


def _triad(length_m: float) -> Any:
    return rerun_module().Arrows3D(vectors=np.eye(3) * length_m, colors=_ERROR_COLOURS, labels=["x", "y", "z"])


def _size(replay: Replay) -> float:
    """A length in keeping with the target [m]."""
    reach = np.linalg.norm(replay.keypoints_m, axis=1) if len(replay.keypoints_m) else np.ones(1)
    return float(max(reach.max(), 0.1))


def _transform(T: Pose) -> Any:
    rr = rerun_module()
    return rr.Transform3D(translation=T.t_m, quaternion=rr.Quaternion(xyzw=_xyzw(T.q_wxyz)))


def _xyzw(q_wxyz: QuatWxyz) -> Float[np.ndarray, "xyzw=4"]:
    return np.roll(q_wxyz, -1)


def _finite(pixels: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "m 2"]:
    return pixels[np.isfinite(pixels).all(axis=1)]


def rerun_module() -> Any:
    """Rerun. InputError where it is not installed."""
    try:
        import rerun
    except ImportError:
        raise InputError("replays need Rerun: pip install 'proxnav[view]'") from None
    return rerun
