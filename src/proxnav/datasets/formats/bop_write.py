"""BOP scenewise, written: scene_gt, scene_gt_info, scene_camera, gray or rgb, mask, mask_visib, models, in millimetres.

No range is too far: positions are floats, no frame is left out, and `depth_scale` is chosen so that 16 bits reach the
farthest point of the set (the customary scale of 1 mm saturates at 65.5 m). Files are written for object 1, scene 0.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, UInt16

from proxnav.datasets.formats.bop import MM, image_number, to_json_lines
from proxnav.datasets.formats.labels import LabelRecord, Labels, box_of, need_camera
from proxnav.datasets.formats.options import WriteOptions
from proxnav.datasets.formats.places import place
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.boxes import box_of_mask
from proxnav.geometry.diameter import diameter
from proxnav.images.codecs import encode_png, read_image
from proxnav.storage.files import write_atomic, write_json

OBJECT_ID = 1
_FULL = 65535  # of 16 bits


def write(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """`<split>/000000/`, camera.json, models/, keypoints.json and the list of test targets."""
    camera = need_camera(labels, "bop")
    split = (options.split or "test").replace("/", "_")
    scene, scale = folder / split / "000000", depth_scale_mm(labels)
    truth, info, cameras = {}, {}, {}
    for record, key in zip(labels.records, image_ids(labels.records), strict=True):
        truth[key] = [] if record.T_cam_target is None else [_pose(record)]
        info[key] = [] if record.T_cam_target is None else [_info(record)]
        cameras[key] = _camera(camera, scale, record.filename)
        _place(record, scene, key, options)
    for name, content in (("scene_gt", truth), ("scene_gt_info", info), ("scene_camera", cameras)):
        write_atomic(scene / f"{name}.json", to_json_lines(content))
    write_json(folder / "camera.json", _whole_camera(camera, scale), indent=1)
    targets = [{"scene_id": 0, "im_id": k, "obj_id": OBJECT_ID, "inst_count": 1} for k in sorted(truth) if truth[k]]
    write_json(folder / "test_targets_bop19.json", targets, indent=1)
    _models(labels, folder, options)


def image_ids(records: Sequence[LabelRecord]) -> list[int]:
    """The numbers in the names where they are all different, else places in the list."""
    try:
        numbers = [image_number(record.filename) for record in records]
    except InputError:
        return list(range(len(records)))
    return numbers if len(set(numbers)) == len(numbers) else list(range(len(records)))


def depth_scale_mm(labels: Labels) -> float:
    """Millimetres per count of a 16-bit depth image that reaches the set's farthest point; at least 0.1.

    >>> from proxnav.geometry import Pose
    >>> far = LabelRecord("0.png", Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [0, 0, 100.0]))
    >>> depth_scale_mm(Labels((far,)))
    1.6
    """
    ranges = [float(np.linalg.norm(r.T_cam_target.t_m)) for r in labels.records if r.T_cam_target is not None]
    radius = 0.0 if labels.keypoints_m is None else float(np.linalg.norm(labels.keypoints_m, axis=1).max())
    far_mm = (max(ranges, default=0.0) + radius) * MM
    return max(float(np.ceil(far_mm / _FULL * 10.0) / 10.0), 0.1)


def encode_depth(depth_m: Float[np.ndarray, "height width"], scale_mm: float) -> UInt16[np.ndarray, "height width"]:
    """A depth image as BOP stores it; 0 where there is none. InputError where a depth does not fit into 16 bits."""
    counts = np.rint(np.where(np.isfinite(depth_m), depth_m, 0.0) * MM / scale_mm)
    if counts.max(initial=0.0) > _FULL:
        raise InputError(
            f"a depth of {counts.max() * scale_mm / MM:.1f} m does not fit 16 bits of {scale_mm:g} mm; use a larger one"
        )
    return counts.astype(np.uint16)


def decode_depth(counts: UInt16[np.ndarray, "height width"], scale_mm: float) -> Float[np.ndarray, "height width"]:
    """Depth [m], NaN where there is none."""
    return np.where(counts > 0, counts * (scale_mm / MM), np.nan)


def _pose(record: LabelRecord) -> dict[str, Any]:
    T = record.T_cam_target
    if T is None:
        raise AssertionError("a record without a pose has no entry")
    return {"cam_R_m2c": T.R.ravel().tolist(), "cam_t_m2c": (T.t_m * MM).tolist(), "obj_id": OBJECT_ID}


def _info(record: LabelRecord) -> dict[str, Any]:
    """One object alone: all of it that the image holds is visible. No depth image, so no pixel has valid depth."""
    if record.mask is None:
        box, count = (box_of(record, "bop") if record.keypoints_px is not None else record.box_xyxy), -1
    else:
        mask = read_image(record.mask)
        mask = (mask if mask.ndim == 2 else mask[..., 0]) > 127
        box, count = box_of_mask(mask), int(mask.sum())
        box = record.box_xyxy if record.box_xyxy is not None else box
    x0, y0, x1, y1 = (float(v) for v in (np.full(4, -1.0) if box is None or np.isnan(box).any() else box))
    edges = [x0, y0, x1 - x0, y1 - y0] if x1 > x0 else [-1.0, -1.0, -1.0, -1.0]
    return {
        "bbox_obj": edges, "bbox_visib": edges, "px_count_all": count, "px_count_valid": 0,
        "px_count_visib": count, "visib_fract": 0.0 if count == 0 else 1.0,
    }  # fmt: skip


def _camera(camera: Camera, scale: float, name: str) -> dict[str, Any]:
    entry: dict[str, Any] = {"cam_K": camera.K.ravel().tolist(), "depth_scale": scale}
    if camera.is_distorted:
        entry["distortion"] = list(camera.distortion)
    if camera.projection == "fisheye":
        entry["projection"] = camera.projection
    return entry | {"pixel_origin": "corner", "file_name": name}


def _whole_camera(camera: Camera, scale: float) -> dict[str, Any]:
    size = {"width": camera.width, "height": camera.height}
    return {"fx": camera.fx, "fy": camera.fy, "cx": camera.cx, "cy": camera.cy, "depth_scale": scale} | size


def _place(record: LabelRecord, scene: Path, key: int, options: WriteOptions) -> None:
    if record.image is not None and options.images != "none":
        _place_image(record.image, scene, key, options)
    for kind in ("mask", "mask_visib"):
        place(record.mask, scene / kind / f"{key:06d}_000000.png", options)


def _place_image(source: Path, scene: Path, key: int, options: WriteOptions) -> None:
    """The image in gray/ or rgb/; where its channels are not those of the folder it is written anew as PNG."""
    image = read_image(source)
    kind = ("gray" if image.ndim == 2 else "rgb") if options.bop_images == "auto" else options.bop_images
    if (image.ndim == 2) == (kind == "gray"):
        place(source, scene / kind / f"{key:06d}{source.suffix.lower()}", options)
        return
    if kind == "rgb":
        image = np.repeat(image[..., None], 3, axis=2)
    else:
        image = np.rint(image.astype(np.float64).mean(axis=2)).astype(image.dtype)
    write_atomic(scene / kind / f"{key:06d}.png", encode_png(image))


def _models(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """models_info.json from the mesh, else from the keypoints; the mesh as PLY; the keypoints, which BOP lacks.

    In models/ for rendering and in models_eval/, which the toolkit's scores read, alike.
    """
    mesh = options.target
    points = mesh.vertices_m if mesh is not None else labels.keypoints_m
    if labels.keypoints_m is not None:
        content = {"keypoint_names": list(labels.keypoint_names), "keypoints_m": labels.keypoints_m.tolist()}
        write_json(folder / "keypoints.json", content, indent=1)
    if points is None:
        return
    for kind in ("models", "models_eval"):
        write_json(folder / kind / "models_info.json", {str(OBJECT_ID): _extents(points * MM)}, indent=1)
    if mesh is not None:
        import trimesh

        model = trimesh.Trimesh(mesh.vertices_m * MM, mesh.faces, process=False)
        data: Any = model.export(file_type="ply", encoding="ascii", vertex_normal=True)
        for kind in ("models", "models_eval"):
            content = data if isinstance(data, bytes) else data.encode()
            write_atomic(folder / kind / f"obj_{OBJECT_ID:06d}.ply", content)


def _extents(points_mm: Float[np.ndarray, "n 3"]) -> dict[str, float]:
    low, size = points_mm.min(axis=0), np.ptp(points_mm, axis=0)
    found = {"diameter": diameter(points_mm)}
    found |= {f"min_{axis}": float(v) for axis, v in zip("xyz", low, strict=True)}
    return found | {f"size_{axis}": float(v) for axis, v in zip("xyz", size, strict=True)}
