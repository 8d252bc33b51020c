"""One hand-computed case per convention, and readers written from the published descriptions alone."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from scipy.io import loadmat

from boxcraft import CORNERS
from proxnav.datasets.formats import Labels, ReadOptions, WriteOptions, read_labels, write_labels
from proxnav.datasets.formats.speed_trees import SPEED_CAMERA
from proxnav.datasets.formats.urso import URSO_CAMERA
from proxnav.errors import InputError
from proxnav.geometry import Camera

S = np.sqrt(0.5)
QUARTER_TURN_Z = [S, 0.0, 0.0, S]  # wxyz: x to y
PINHOLE = Camera(64, 48, 60.0, 61.0, 32.0, 24.0)


def read_text(tmp_path: Path, name: str, text: str, format: str = "auto", options: ReadOptions | None = None) -> Labels:
    path = tmp_path / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return read_labels(path, format, options)


def x_axis(labels: Labels) -> np.ndarray:
    return labels.records[0].T_cam_target @ np.array([1.0, 0.0, 0.0])


def test_spec2019_is_scalar_first(tmp_path: Path) -> None:
    labels = read_text(tmp_path, "s.csv", f"img1.jpg,{S},0,0,{S},1,2,10\n")
    assert labels.format == "spec2019"
    np.testing.assert_allclose(x_axis(labels), [1.0, 3.0, 10.0], atol=1e-12)


def test_spec2021_names_its_category(tmp_path: Path) -> None:
    labels = read_text(tmp_path, "s.csv", f"sunlamp,img1.jpg,{S},0,0,{S},1,2,10\n")
    assert (labels.format, labels.records[0].split) == ("spec2021", "sunlamp")
    np.testing.assert_allclose(x_axis(labels), [1.0, 3.0, 10.0], atol=1e-12)


@pytest.mark.parametrize("header", ["", "filename,sequence,Tx,Ty,Tz,Qx,Qy,Qz,Qw\n"])
def test_spark_is_scalar_last(tmp_path: Path, header: str) -> None:
    labels = read_text(tmp_path, "s.csv", f"{header}img1.jpg,GT001,1,2,10,0,0,{S},{S}\n")
    assert (labels.format, labels.records[0].split) == ("spark", "GT001")
    np.testing.assert_allclose(x_axis(labels), [1.0, 3.0, 10.0], atol=1e-12)


def test_bop_results_are_millimetres_row_by_row(tmp_path: Path) -> None:
    text = "scene_id,im_id,obj_id,score,R,t,time\n2,12,1,0.5,0 -1 0 1 0 0 0 0 1,1000 2000 10000,-1\n"
    labels = read_text(tmp_path, "r.csv", text)
    assert (labels.format, labels.records[0].filename, labels.records[0].split) == (
        "bop-results",
        "000012.png",
        "000002",
    )
    np.testing.assert_allclose(x_axis(labels), [1.0, 3.0, 10.0], atol=1e-12)


def test_krn_boxes_are_x_x_y_y(tmp_path: Path) -> None:
    text = f"synthetic/images/img1.jpg, 10, 30, 5, 25, {S}, 0, 0, {S}, 1, 2, 10, 11.5, 12.5, 13.5, 14.5\n"
    labels = read_text(tmp_path, "synthetic/splits_krn/train.csv", text)
    record = labels.records[0]
    assert (labels.format, record.filename, record.split) == ("krn", "img1.jpg", "synthetic/train")
    np.testing.assert_array_equal(record.box_xyxy, [10.0, 5.0, 30.0, 25.0])
    np.testing.assert_array_equal(record.keypoints_px, [[11.5, 12.5], [13.5, 14.5]])
    np.testing.assert_allclose(x_axis(labels), [1.0, 3.0, 10.0], atol=1e-12)


def test_spnv2_is_normalised_and_has_the_origin_before_the_keypoints(tmp_path: Path) -> None:
    text = f"img1.jpg, 0.25, 0.5, 0.75, 1.0, {S}, 0, 0, {S}, 1, 2, 10, 0.1, 0.2, 0.5, 0.25, 0.125, 0.75\n"
    labels = read_text(tmp_path, "l.csv", text, options=ReadOptions(camera=PINHOLE))
    record = labels.records[0]
    assert labels.format == "spnv2"
    np.testing.assert_array_equal(record.box_xyxy, [16.0, 24.0, 48.0, 48.0])
    np.testing.assert_array_equal(record.keypoints_px, [[32.0, 12.0], [8.0, 36.0]])


def test_spnv2_without_a_camera_says_what_is_missing(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--camera"):
        read_text(tmp_path, "l.csv", "img1.jpg,0,0,1,1,1,0,0,0,0,0,9,.1,.2,.5,.2\n")


def _urso_pixel(point_urso: np.ndarray, q_xyzw: np.ndarray, t_urso: np.ndarray) -> np.ndarray:
    """How UrsoNet draws a point of the target: camera axes (y, z, x) of Unreal's, u = cx + fx X/Z, v = cy - |fy| Y/Z.

    The matrix is that of the left-handed quaternion (Trawny and Roumeliotis, eq. 62): the transpose of Hamilton's.
    """
    v, w = q_xyzw[:3], q_xyzw[3]
    cross = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    R = (2.0 * w**2 - 1.0) * np.eye(3) - 2.0 * w * cross + 2.0 * np.outer(v, v)
    X, Y, Z = R @ point_urso + t_urso[[1, 2, 0]]
    return np.array([640.0 + 640.0 * X / Z, 480.0 - URSO_CAMERA.fy * Y / Z])


def test_urso_points_fall_where_ursonet_draws_them(tmp_path: Path, rng: np.random.Generator) -> None:
    q = rng.normal(size=4)
    q /= np.linalg.norm(q)
    t = np.array([20.0, -3.0, 4.0])
    (tmp_path / "train_images.csv").write_text("images/0_rgb.png\n")
    numbers = ",".join(repr(float(value)) for value in (*t, *q))
    (tmp_path / "train_poses_gt.csv").write_text(f"x,y,z,q1,q2,q3,q4\n{numbers}\n")
    labels = read_labels(tmp_path)
    assert labels.camera == URSO_CAMERA
    mirrored = CORNERS * (1.0, -1.0, 1.0)  # the same corners in the left-handed frame of the file
    drawn = np.array([_urso_pixel(point, q, t) for point in mirrored])
    np.testing.assert_allclose(URSO_CAMERA.project(labels.records[0].T_cam_target @ CORNERS), drawn, atol=1e-9)


def test_urso_fields_of_view_are_those_published() -> None:
    half = np.arctan([640.0 / URSO_CAMERA.fx, 480.0 / URSO_CAMERA.fy])
    np.testing.assert_allclose(np.rad2deg(2.0 * half), [90.0, 73.7], atol=1e-9)


def test_speed_of_2019_has_its_fixed_camera(tmp_path: Path) -> None:
    (tmp_path / "images" / "train").mkdir(parents=True)
    entry = {"filename": "img1.jpg", "q_vbs2tango": QUARTER_TURN_Z, "r_Vo2To_vbs_true": [1, 2, 10]}
    (tmp_path / "train.json").write_text(json.dumps([entry]))
    labels = read_labels(tmp_path)
    assert labels.camera == SPEED_CAMERA
    assert SPEED_CAMERA.fx == pytest.approx(3003.41297, abs=5e-6)
    np.testing.assert_allclose(x_axis(labels), [1.0, 3.0, 10.0], atol=1e-12)


def test_detectron2_gets_half_a_pixel_less_and_boxes_as_they_are(labels: Labels, tmp_path: Path) -> None:
    ours = json.loads((write_labels(labels, tmp_path / "coco", "coco") / "annotations.json").read_text())
    theirs = json.loads((write_labels(labels, tmp_path / "d2", "detectron2") / "annotations.json").read_text())
    for a, b in zip(ours["annotations"], theirs["annotations"], strict=True):
        a_px, b_px = np.reshape(a["keypoints"], (-1, 3)), np.reshape(b["keypoints"], (-1, 3))
        np.testing.assert_allclose(a_px[:, :2] - b_px[:, :2], 0.5, atol=1e-12)
        np.testing.assert_array_equal(a_px[:, 2], b_px[:, 2])
        assert a["bbox"] == b["bbox"]
    assert theirs["info"]["keypoint_origin"] == "pixel centre"


def test_coco_without_a_pixel_origin_is_refused_until_it_is_said(labels: Labels, tmp_path: Path) -> None:
    path = write_labels(labels, tmp_path / "out", "coco") / "annotations.json"
    content = json.loads(path.read_text())
    del content["info"]["keypoint_origin"]
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match="--pixel-origin"):
        read_labels(path)
    centre = read_labels(path, options=ReadOptions(pixel_origin="centre"))
    corner = read_labels(path, options=ReadOptions(pixel_origin="corner"))
    np.testing.assert_allclose(centre.records[0].keypoints_px - corner.records[0].keypoints_px, 0.5)


def test_our_data_set_as_speedplus_satisfies_its_published_description(labels: Labels, tmp_path: Path) -> None:
    """speedplusv2/{synthetic/{images, train.json, validation.json}, camera.json}; X_cam = R(q) X + r, scalar first."""
    root = write_labels(labels, tmp_path / "speedplusv2", "speed+")
    camera = json.loads((root / "camera.json").read_text())
    for value in camera.values():
        np.asarray(value, dtype=np.float32)  # SPNv2 casts every value
    K, dist = np.array(camera["cameraMatrix"]), np.array(camera["distCoeffs"])
    points = loadmat(root / "tangoPoints.mat")["tango3Dpoints"]
    truth, seen = {record.filename: record for record in labels.records}, 0
    for split in ("train", "validation"):
        for entry in json.loads((root / "synthetic" / f"{split}.json").read_text()):
            assert set(entry) == {"filename", "q_vbs2tango_true", "r_Vo2To_vbs_true"}
            image = cv2.imread(str(root / "synthetic" / "images" / entry["filename"]), cv2.IMREAD_GRAYSCALE)
            assert image.shape == (camera["Nv"], camera["Nu"])
            w, x, y, z = entry["q_vbs2tango_true"]
            R = np.array(
                [
                    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
                ]
            )
            r = np.array(entry["r_Vo2To_vbs_true"])
            drawn, _ = cv2.projectPoints(points.T, cv2.Rodrigues(R)[0], r, K, dist)
            expected = truth[entry["filename"]]
            np.testing.assert_allclose(R, expected.T_cam_target.R, rtol=0, atol=1e-9)
            np.testing.assert_allclose(r, expected.T_cam_target.t_m, rtol=0, atol=1e-9)
            np.testing.assert_allclose(drawn[:, 0], expected.keypoints_px, atol=1e-6)  # px, through OpenCV
            seen += 1
    assert seen == len(labels)


def test_our_data_set_as_bop_satisfies_its_published_description(labels: Labels, tmp_path: Path) -> None:
    """scene_gt, scene_gt_info, scene_camera, gray, mask, mask_visib, models_info; millimetres; 100 m as well."""
    root = write_labels(labels, tmp_path / "bop", "bop")
    scene = root / "test" / "000000"
    truth, info, cameras = (
        json.loads((scene / f"scene_{part}.json").read_text()) for part in ("gt", "gt_info", "camera")
    )
    whole = json.loads((root / "camera.json").read_text())
    assert set(whole) == {"fx", "fy", "cx", "cy", "width", "height", "depth_scale"}
    by_number = {int(record.filename[3:-4]): record for record in labels.records}
    assert sorted(map(int, truth)) == sorted(by_number)
    for key, (entry,) in truth.items():
        record = by_number[int(key)]
        np.testing.assert_allclose(np.reshape(entry["cam_R_m2c"], (3, 3)), record.T_cam_target.R, rtol=0, atol=1e-9)
        np.testing.assert_allclose(np.array(entry["cam_t_m2c"]) / 1000.0, record.T_cam_target.t_m, rtol=0, atol=1e-9)
        np.testing.assert_array_equal(np.reshape(cameras[key]["cam_K"], (3, 3)), labels.camera.K)
        mask = cv2.imread(str(scene / "mask_visib" / f"{int(key):06d}_000000.png"), cv2.IMREAD_GRAYSCALE)
        image = cv2.imread(str(scene / "gray" / f"{int(key):06d}.png"), cv2.IMREAD_UNCHANGED)
        assert image.shape == (whole["height"], whole["width"])
        x, y, w, h = info[key][0]["bbox_visib"]
        assert info[key][0]["px_count_visib"] == (mask == 255).sum() == w * h
        assert (mask[int(y) : int(y + h), int(x) : int(x + w)] == 255).all()
        assert np.linalg.norm(entry["cam_t_m2c"]) < 65535 * cameras[key]["depth_scale"]
    assert max(entry["cam_t_m2c"][2] for (entry,) in truth.values()) == pytest.approx(100_000.0)
    model = json.loads((root / "models" / "models_info.json").read_text())["1"]
    assert model["diameter"] == pytest.approx(1000.0 * np.linalg.norm([3.0, 2.0, 1.2]))
    assert (model["min_x"], model["size_x"]) == (-1500.0, 3000.0)


def test_our_data_set_as_krn_and_spnv2_has_the_columns_that_their_loaders_take(labels: Labels, tmp_path: Path) -> None:
    krn = write_labels(labels, tmp_path / "krn", "krn", WriteOptions(validation_share=0.0))
    rows = np.genfromtxt(krn / "synthetic" / "splits_krn" / "train.csv", delimiter=",", dtype=str)
    for row, record in zip(rows, labels.records, strict=True):
        assert (krn / row[0]).is_file()
        np.testing.assert_allclose(row[12:].astype(float).reshape(8, 2), record.keypoints_px, atol=1e-9)
        np.testing.assert_allclose(row[9:12].astype(float), record.T_cam_target.t_m, atol=1e-9)
    spnv2 = write_labels(labels, tmp_path / "spnv2", "spnv2", WriteOptions(validation_share=0.0))
    rows = np.genfromtxt(spnv2 / "synthetic" / "labels" / "train.csv", delimiter=",", dtype=str)
    for row, record in zip(rows, labels.records, strict=True):
        size = np.array([labels.camera.width, labels.camera.height])
        origin = labels.camera.project(record.T_cam_target.t_m)
        np.testing.assert_allclose(row[12:14].astype(float) * size, origin, atol=1e-9)
        np.testing.assert_allclose(row[14:].astype(float).reshape(8, 2) * size, record.keypoints_px, atol=1e-9)


def test_bop_with_several_objects_asks_which(tmp_path: Path) -> None:
    scene = tmp_path / "000000"
    scene.mkdir()
    pose = {"cam_R_m2c": np.eye(3).ravel().tolist(), "cam_t_m2c": [0, 0, 5000.0]}
    entries = [pose | {"obj_id": 3}, pose | {"obj_id": 5, "cam_t_m2c": [0, 0, 7000.0]}]
    (scene / "scene_gt.json").write_text(json.dumps({"0": entries}))
    (scene / "scene_camera.json").write_text(
        json.dumps({"0": {"cam_K": PINHOLE.K.ravel().tolist(), "depth_scale": 1.0}})
    )
    (tmp_path / "camera.json").write_text(json.dumps({"width": 64, "height": 48}))
    with pytest.raises(InputError, match=r"3, 5.*--object-id"):
        read_labels(tmp_path)
    labels = read_labels(tmp_path, options=ReadOptions(object_id=5))
    np.testing.assert_array_equal(labels.records[0].T_cam_target.t_m, [0.0, 0.0, 7.0])
    assert labels.camera == PINHOLE
