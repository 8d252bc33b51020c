"""Every reader of foreign files by name: the file names it knows and how it is called; for tests and for fuzzing."""

import json
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.errors import InputError


@dataclass(frozen=True)
class Reader:
    """Reads one file of a folder in which its neighbours are whole."""

    names: tuple[str, ...]
    """File names under which hostile bytes are laid down."""
    read: Callable[[Path], Any]
    prepare: Callable[[Path], Any] = lambda folder: None
    """Makes the neighbours."""


def value_or_refusal(reader: Reader, path: Path) -> str | None:
    """The refusal's sentence, or None where the file was read; any other exception goes through."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            reader.read(path)
        except InputError as error:
            return str(error)
    return None


def _trajectory(path: Path) -> None:
    from proxnav.trajectories import ReaderConfig, read_trajectory

    paths = [path.parent / "orbit.e", path] if path.name in ("craft.a", "craft.aem") else [path]
    found = read_trajectory(paths, ReaderConfig(frame="J2000"))
    assert np.isfinite(found.r_eci_target_m).all()


def _orbit_beside(folder: Path) -> None:
    from proxnav.trajectories import HoldConfig, hold
    from proxnav.trajectories.write import stk_ephemeris

    (folder / "orbit.e").write_text(stk_ephemeris(hold(HoldConfig(duration_s=40.0, step_s=10.0)), "target"))


def _camera(path: Path) -> None:
    from proxnav.geometry.camera_files import read_camera_file

    read_camera_file(path).camera.project(np.array([[0.1, 0.2, 5.0]]))


def _labels(path: Path) -> None:
    from proxnav.datasets.formats import ReadOptions, read_labels
    from proxnav.geometry import Camera

    read_labels(path, "auto", ReadOptions(camera=Camera(64, 48, 60.0, 61.0, 32.0, 24.0)))


def _dataset(path: Path) -> None:
    from proxnav.datasets.set.dataset import Dataset

    dataset = Dataset(path.parent)
    _ = dataset.labels, dataset.camera, dataset.keypoints_m, dataset.target_name
    for _ in dataset.scenes():
        pass
    dataset.image(0), dataset.mask(0)


def _dataset_beside(folder: Path) -> None:
    from tests.datasets.formats.small_sets import make_dataset

    make_dataset(folder, 1)


def _bop(path: Path) -> None:
    from proxnav.datasets.formats import read_labels

    read_labels(path.parent, "bop")


def _bop_beside(folder: Path) -> None:
    (folder / "scene_gt.json").write_text(
        '{"3": [{"cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cam_t_m2c": [0, 0, 9000], "obj_id": 1}]}'
    )
    (folder / "scene_camera.json").write_text('{"3": {"cam_K": [60, 0, 32, 0, 60, 24, 0, 0, 1], "depth_scale": 1}}')
    (folder / "scene_gt_info.json").write_text('{"3": [{"bbox_obj": [1, 2, 3, 4]}]}')
    (folder / "camera.json").write_text('{"width": 64, "height": 48}')
    (folder / "keypoints.json").write_text("[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]")


def _keypoints(path: Path) -> None:
    from proxnav.pose.solve.keypoint_files import read_keypoints

    read_keypoints(path)


def _points(path: Path) -> None:
    from proxnav.targets.keypoints.point_files import load_points

    load_points(path)


def _mesh(path: Path) -> None:
    from proxnav.targets.cad.mesh_file import read_mesh

    read_mesh(path)


def _target(path: Path) -> None:
    from proxnav.targets.target_files import read_target

    read_target(path.parent / "target.json")


def _target_beside(folder: Path) -> None:
    from boxcraft import boxcraft
    from proxnav.targets.target_files import save_target

    save_target(boxcraft(), folder)


def _image(path: Path) -> None:
    from proxnav.images.codecs import read_image
    from proxnav.images.tones import grey_8_bit

    grey_8_bit(read_image(path))


def _records(path: Path) -> None:
    from proxnav.datasets.sensor_records.record_files import read_records
    from proxnav.flight.truth_files import read_truth

    read_truth(path) if path.name == "truth.csv" else read_records(path.parent)


def _records_beside(folder: Path) -> None:
    from proxnav.datasets.sensor_records.record_tables import TABLES

    (folder / "records.json").write_text('{"version": 1, "epoch_utc": "2024-11-01T00:00:00Z"}')
    rows = {"ephemeris": "0,7e6,0,0,0,7500,0\n10,7e6,75000,0,0,7500,0\n", "poses": "1,1,1,0,0,0,0,0,9" + ",1" * 21}
    for name, row in rows.items():
        (folder / f"{name}.csv").write_text(",".join(TABLES[name].columns) + "\n" + row + "\n")


def _model(path: Path) -> None:
    from proxnav.estimator import PoseEstimator

    if path.suffix == ".onnx":
        (path.parent / "model.json").write_text(_card("heatmap" if path.stem == "finder" else "keypoint-rcnn"))
    PoseEstimator.load(str(path.parent), "onnxruntime", 1)


def _card(detector: str) -> str:
    calibration = {"min_score": 0.5, "looks": 1, "calibration": {"scale": 1.0, "floor_px": 0.0}}
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    settings = {"crop_side": 64} if detector == "heatmap" else calibration
    card = {"detector": detector, "target": "x", "keypoint_names": list("abcd"), "keypoints_m": points}
    return json.dumps(card | {"settings": settings})


def _tensors(path: Path) -> None:
    import torch

    from proxnav.detection.keypoint_rcnn.weights import read_state
    from proxnav.detection.training.files import load_checkpoint, load_weights

    load_weights(torch.nn.Linear(2, 3), path) if path.suffix == ".safetensors" else load_checkpoint(path)
    read_state(path)


READERS: dict[str, Reader] = {
    "trajectories": Reader(
        ("craft.e", "craft.a", "craft.oem", "craft.aem", "craft.xml", "report.txt", "table.csv", "table.mat"),
        _trajectory, _orbit_beside,
    ),
    "camera": Reader(("camera.json", "camera.yaml", "camera.xml", "camera.npz", "camera.mat"), _camera),
    "labels": Reader(("labels.json", "annotations.json", "poses.json"), _labels),
    "tables": Reader(("labels.csv", "submission.csv"), _labels),
    "dataset": Reader(("annotations.json", "scenes.jsonl", "target.json", "camera.json"), _dataset, _dataset_beside),
    "bop": Reader(
        ("scene_gt.json", "scene_camera.json", "scene_gt_info.json", "camera.json", "keypoints.json"),
        _bop, _bop_beside,
    ),
    "keypoints": Reader(("keypoints.json",), _keypoints),
    "points": Reader(("points.mat", "points.json", "points.csv"), _points),
    "meshes": Reader(("mesh.glb", "mesh.gltf", "mesh.obj", "mesh.stl", "mesh.ply", "mesh.dae"), _mesh),
    "target": Reader(("target.json", "mesh.npz"), _target, _target_beside),
    "images": Reader(("a.png", "a.jpg", "a.tif", "a.bmp", "a.pgm"), _image),
    "records": Reader(("ephemeris.csv", "poses.csv", "records.json", "gyro.csv", "gnss.csv", "truth.csv"),
                      _records, _records_beside),
    "model": Reader(("model.json", "finder.onnx", "keypoint-rcnn.onnx"), _model),
    "tensors": Reader(("w.safetensors", "checkpoint.pt"), _tensors),
}  # fmt: skip
