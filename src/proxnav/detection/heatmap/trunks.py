"""Trunks of the pyramid: a stem and four stages, at 1/4, 1/8, 1/16 and 1/32 of a grey image.

K. He et al., "Deep Residual Learning for Image Recognition", CVPR 2016; A. Howard et al., "Searching for MobileNetV3",
ICCV 2019. Which one is worth its time is measured in docs/notes/detector_history.md.
"""

from functools import partial

import torchvision
from torch import nn
from torchvision.models.resnet import BasicBlock, ResNet

from proxnav.detection.heatmap.config import Trunk


def build_trunk(trunk: Trunk) -> tuple[nn.Sequential, nn.ModuleList, list[int]]:
    """Stem, stages and the channels that the stages give; weights are random."""
    return _mobilenet() if trunk == "mobilenet" else _resnet(trunk)


def _resnet(trunk: Trunk) -> tuple[nn.Sequential, nn.ModuleList, list[int]]:
    resnet = ResNet(BasicBlock, [1, 1, 1, 1]) if trunk == "resnet10" else getattr(torchvision.models, trunk)()
    first = nn.Conv2d(1, 64, kernel_size=7, stride=2, padding=3, bias=False)
    stem = nn.Sequential(first, resnet.bn1, resnet.relu, resnet.maxpool)
    stages = nn.ModuleList([resnet.layer1, resnet.layer2, resnet.layer3, resnet.layer4])
    expansion = 4 if trunk == "resnet50" else 1
    return stem, stages, [expansion * c for c in (64, 128, 256, 512)]


def _mobilenet() -> tuple[nn.Sequential, nn.ModuleList, list[int]]:
    """MobileNetV3-Large without its last, widest layer; each stage ends where the resolution halves next."""
    # Its own batch statistics would follow a hundred steps behind (momentum 0.01), which suits runs of weeks.
    norm = partial(nn.BatchNorm2d, eps=1e-3, momentum=0.1)
    features = torchvision.models.mobilenet_v3_large(norm_layer=norm).features
    first = nn.Conv2d(1, 16, kernel_size=3, stride=2, padding=1, bias=False)
    stem = nn.Sequential(first, *list(features[0].children())[1:], features[1])
    stages = nn.ModuleList([features[a:b] for a, b in ((2, 4), (4, 7), (7, 13), (13, 16))])
    return stem, stages, [24, 40, 112, 160]
