"""torchvision's Keypoint R-CNN as it comes, which others are timed against."""

from collections.abc import Callable

import torch
from torchvision.models.detection import keypointrcnn_resnet50_fpn

from proxnav.geometry.types import GreyImage


def untrained_keypoint_rcnn(threads: int) -> Callable[[GreyImage], object]:
    """Six keypoints, float32, eager, 800 px, weights drawn at random; `threads` 0 takes all cores.

    Untrained it proposes as many boxes as a trained one, but keeps fewer of them for the keypoint head: it is faster
    than a trained one.
    """
    if threads:
        torch.set_num_threads(threads)
    net = keypointrcnn_resnet50_fpn(weights=None, weights_backbone=None, num_keypoints=6).eval()

    def detect(image: GreyImage) -> object:
        colour = torch.from_numpy(image).float().div(255.0).expand(3, -1, -1)
        with torch.inference_mode():
            return net([colour])

    return detect
