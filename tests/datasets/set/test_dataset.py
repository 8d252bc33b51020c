import json

import numpy as np
import pytest

from boxcraft import boxcraft
from proxnav.datasets.set.dataset import Dataset
from proxnav.datasets.set.labelling import label_frame
from proxnav.datasets.set.writer import DatasetWriter
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.records import HIDDEN, NOT_IN_IMAGE, VISIBLE, EarthSpec, SceneSpec, SunSpec

CAMERA = Camera(64, 48, 60.0, 61.0, 32.0, 24.0, (-0.1, 0.02, 0.0, 0.001, 0.0))


def scene(index=0, z=10.0):
    return SceneSpec(
        index, "boxcraft", CAMERA, (0.9, 0.1, -0.3, np.sqrt(0.09)), (0.1, 0.2, z), SunSpec((0.6, 0.0, 0.8)),
        EarthSpec((0.0, 0.0, 6.778e6), (1.0, 0.0, 0.0, 0.0)),
    )  # fmt: skip


def write(folder, scenes, upto=None):
    writer, target = DatasetWriter(folder), boxcraft()
    for one in writer.begin(scenes, target)[:upto]:
        image = np.random.default_rng(one.index).integers(0, 255, (48, 64), dtype=np.uint8)
        mask = image > 200
        writer.add(one, image, mask, label_frame(one, target, mask, np.ones(8, dtype=bool)))
    return writer


def test_keypoints_are_labelled_where_the_camera_projects_them():
    target = boxcraft()
    unoccluded = np.arange(8) % 2 == 0
    label = label_frame(scene(), target, np.zeros((48, 64), bool), unoccluded)
    by_hand = CAMERA.project(scene().T_cam_target.transform(target.keypoints_m))
    np.testing.assert_array_equal(label.keypoints_px, by_hand)
    inside = CAMERA.contains(by_hand)
    assert (label.visibility[inside & unoccluded] == VISIBLE).all()
    assert (label.visibility[inside & ~unoccluded] == HIDDEN).all()
    assert (label.visibility[~inside] == NOT_IN_IMAGE).all()


def test_a_data_set_reads_back_what_was_written(tmp_path):
    scenes = [scene(i, 8.0 + i) for i in range(3)]
    write(tmp_path / "set", scenes).finish(scenes, boxcraft())
    dataset, target = Dataset(tmp_path / "set"), boxcraft()
    assert len(dataset) == 3
    assert dataset.camera == CAMERA
    assert dataset.keypoint_names == target.keypoint_names
    np.testing.assert_array_equal(dataset.keypoints_m, target.keypoints_m)
    assert list(dataset.scenes()) == scenes
    for index, one in enumerate(scenes):
        image = np.random.default_rng(index).integers(0, 255, (48, 64), dtype=np.uint8)
        np.testing.assert_array_equal(dataset.image(index), image)
        np.testing.assert_array_equal(dataset.mask(index), image > 200)
        label = label_frame(one, target, image > 200, np.ones(8, dtype=bool))
        np.testing.assert_allclose(dataset.labels[index].keypoints_px, label.keypoints_px, atol=1e-9)
        np.testing.assert_array_equal(dataset.labels[index].visibility, label.visibility)
        np.testing.assert_array_equal(dataset.labels[index].box_xyxy, label.box_xyxy)


def test_an_interrupted_set_ends_as_an_uninterrupted_one(tmp_path):
    scenes = [scene(i) for i in range(4)]
    write(tmp_path / "whole", scenes).finish(scenes, boxcraft())
    write(tmp_path / "twice", scenes, upto=2)
    (tmp_path / "twice" / "images" / ".img000003.png.x.part").write_bytes(b"half")
    write(tmp_path / "twice", scenes).finish(scenes, boxcraft())
    files = sorted(path.relative_to(tmp_path / "whole") for path in (tmp_path / "whole").rglob("*") if path.is_file())
    again = sorted(path.relative_to(tmp_path / "twice") for path in (tmp_path / "twice").rglob("*") if path.is_file())
    assert files == again
    assert all((tmp_path / "whole" / f).read_bytes() == (tmp_path / "twice" / f).read_bytes() for f in files)


def test_a_folder_of_other_scenes_is_not_overwritten(tmp_path):
    write(tmp_path, [scene(0)])
    with pytest.raises(InputError, match="another data set"):
        DatasetWriter(tmp_path).begin([scene(0, z=11.0)], boxcraft())


def test_a_folder_of_other_files_is_not_written_into(tmp_path):
    (tmp_path / "thesis.tex").write_text("dear reader")
    with pytest.raises(InputError, match="not empty"):
        DatasetWriter(tmp_path).begin([scene()], boxcraft())


def test_annotations_with_another_keypoint_count_are_refused(tmp_path):
    scenes = [scene()]
    write(tmp_path, scenes).finish(scenes, boxcraft())
    content = json.loads((tmp_path / "annotations.json").read_text())
    content["annotations"][0]["keypoints"] = content["annotations"][0]["keypoints"][:-3]
    (tmp_path / "annotations.json").write_text(json.dumps(content))
    with pytest.raises(InputError, match="7 keypoints, the category names 8"):
        _ = Dataset(tmp_path).labels


def test_annotations_cannot_lead_out_of_the_folder(tmp_path):
    scenes = [scene()]
    write(tmp_path / "set", scenes).finish(scenes, boxcraft())
    text = (tmp_path / "set" / "annotations.json").read_text()
    (tmp_path / "set" / "annotations.json").write_text(text.replace("img000000.png", "../../secret.png"))
    with pytest.raises(InputError, match="leads out"):
        Dataset(tmp_path / "set").image(0)


def test_a_data_set_goes_not_into_a_file(tmp_path):
    (tmp_path / "set").write_text("mine")
    with pytest.raises(InputError, match="is a file"):
        write(tmp_path / "set", [scene()])
    assert (tmp_path / "set").read_text() == "mine"


@pytest.mark.parametrize("line", ["[1, 2]", "7", "null", '{"version": 1, "index"'])
def test_a_line_that_is_no_scene_is_named(tmp_path, line):
    folder = write(tmp_path, [scene()]).finish([scene()], boxcraft())
    (folder / "scenes.jsonl").write_text(line + "\n")
    with pytest.raises(InputError, match="line 1"):
        list(Dataset(folder).scenes())
    (folder / "scenes.jsonl").unlink()
    with pytest.raises(InputError, match=r"scenes\.jsonl: no such file"):
        list(Dataset(folder).scenes())
