"""A labelled data set: rendered, written as COCO keypoints, read back, and its labels drawn over the images."""

from pathlib import Path

import cv2

from proxnav.datasets.set.dataset import Dataset
from proxnav.frames import FrameConfig
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.rendered_set import render
from proxnav.viewing.overlay import contact_sheet, overlay


def main(out: Path = Path("out/examples"), frames: int = 8, size: int = 384) -> Dataset:
    """Renders a few frames of the observation mission; run it again and it finds them already there."""
    scenes = draw_scenes(load_mission("observation-10-100m"), frames, seed=0, size=size)
    dataset = render(scenes, FrameConfig("raycast"), out / "dataset", workers=1)
    print(f"{len(dataset)} frames of {dataset.target_name} in {dataset.folder}")

    pictures = []
    for index, label in enumerate(dataset.labels):
        range_m = float((label.T_cam_target.t_m**2).sum() ** 0.5)
        seen = int((label.visibility == 2).sum())
        print(f"  {label.filename}: range {range_m:5.1f} m, {seen} keypoints visible, box {label.box_xyxy.round(0)}")
        image = dataset.image(index)
        drawn = overlay(image, dataset.camera, T_true=label.T_cam_target, points_target_m=dataset.keypoints_m)
        pictures.append(drawn)

    sheet = out / "06_dataset.png"
    cv2.imwrite(str(sheet), contact_sheet(pictures)[..., ::-1])
    print(f"the labels over the images in {sheet}")
    return dataset


if __name__ == "__main__":
    main()
