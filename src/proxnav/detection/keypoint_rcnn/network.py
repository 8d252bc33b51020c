"""Keypoint R-CNN (He et al., "Mask R-CNN", ICCV 2017, section 5) from torchvision's parts, for one target per image."""

from collections import OrderedDict
from collections.abc import Callable
from typing import Any

import torch
from torch import Tensor, nn
from torchvision.models import resnet
from torchvision.models.detection import KeypointRCNN
from torchvision.models.detection.anchor_utils import AnchorGenerator
from torchvision.models.detection.backbone_utils import BackboneWithFPN
from torchvision.models.detection.faster_rcnn import FastRCNNPredictor, TwoMLPHead
from torchvision.models.detection.image_list import ImageList
from torchvision.models.detection.keypoint_rcnn import KeypointRCNNPredictor
from torchvision.models.detection.mask_rcnn import MaskRCNNHeads, MaskRCNNPredictor
from torchvision.models.detection.rpn import RPNHead
from torchvision.ops import MultiScaleRoIAlign
from torchvision.ops.feature_pyramid_network import LastLevelMaxPool

from proxnav.detection.keypoint_rcnn.config import NetworkConfig
from proxnav.detection.keypoint_rcnn.losses import training_losses

GREY_MEAN, GREY_STD = 0.449, 0.226
"""ImageNet's, over its three channels: a user's weights were made for these."""
ASPECTS = (0.5, 1.0, 2.0)
LEVELS = ["0", "1", "2", "3"]


class KeypointRcnn(nn.Module):
    """Square grey images to losses while training, to the best box and its keypoint maps in use."""

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.config = config
        self.parts = _torchvision_network(config)

    def forward(self, batch: dict[str, Any]) -> dict[str, Tensor]:
        """`batch["images"]` (b, side, side) uint8 and, while training, the labels made by `collate`."""
        images, features = self.features(batch["images"])
        if self.training:
            return training_losses(self.parts, self.config, images, features, batch)
        return self.best(images, features)

    def features(self, grey: Tensor) -> tuple[ImageList, OrderedDict[str, Tensor]]:
        """Normalised images and their feature pyramid."""
        x = ((grey.float() / 255.0 - GREY_MEAN) / GREY_STD)[:, None]
        x = x.to(memory_format=torch.channels_last)
        sizes = [(x.shape[2], x.shape[3])] * x.shape[0]
        return ImageList(x, sizes), self.parts.backbone(x)

    def best(self, images: ImageList, features: OrderedDict[str, Tensor]) -> dict[str, Tensor]:
        """The box with the highest score of each image: boxes (b, 4), scores (b,), keypoint_maps (b, n, 56, 56)."""
        heads: Any = self.parts.roi_heads
        proposals, _ = self.parts.rpn(images, features)
        pooled = heads.box_head(heads.box_roi_pool(features, proposals, images.image_sizes))
        logits, deltas = heads.box_predictor(pooled)
        scores = logits.softmax(-1)[:, 1]
        boxes = heads.box_coder.decode(deltas, proposals)[:, 1]
        height, width = images.image_sizes[0]
        upper = boxes.new_tensor([width, height, width, height])
        boxes = torch.minimum(boxes.clamp(min=0.0), upper)
        first = _first_of_each(scores, proposals)
        best_boxes, best_scores = boxes[first], scores[first]
        rois = [box[None] for box in best_boxes]
        pooled = heads.keypoint_roi_pool(features, rois, images.image_sizes)
        found = {
            "boxes": best_boxes,
            "scores": best_scores,
            "keypoint_maps": heads.keypoint_predictor(heads.keypoint_head(pooled)).float(),
        }
        if self.config.mask:
            pooled = heads.mask_roi_pool(features, rois, images.image_sizes)
            found["mask_maps"] = heads.mask_predictor(heads.mask_head(pooled)).float()[:, 1].sigmoid()
        return found


def _first_of_each(scores: Tensor, proposals: list[Tensor]) -> Tensor:
    """Row of the highest score among each image's proposals, which lie one after the other."""
    rows, start = [], 0
    for boxes in proposals:
        rows.append(scores[start : start + boxes.shape[0]].argmax() + start)
        start += boxes.shape[0]
    return torch.stack(rows)


class InFloat32(nn.Module):
    """Gives a head's outputs in float32: boxes computed in bfloat16 would be whole pixels off."""

    def __init__(self, head: nn.Module) -> None:
        super().__init__()
        self.head = head

    def forward(self, x: Any) -> Any:
        """What the head gives."""
        first, second = self.head(x)
        if isinstance(first, list):
            return [a.float() for a in first], [b.float() for b in second]
        return first.float(), second.float()


def group_norm(channels: int) -> nn.Module:
    """GroupNorm in at most 32 groups (Wu and He, ECCV 2018)."""
    return nn.GroupNorm(min(32, channels // 4), channels)


def _torchvision_network(config: NetworkConfig) -> KeypointRCNN:
    channels = config.pyramid_channels
    sizes = tuple((size,) for size in config.anchor_sizes)
    network = KeypointRCNN(
        _backbone(config),
        num_classes=None,  # type: ignore[arg-type]  # a predictor is given: background and target
        rpn_anchor_generator=AnchorGenerator(sizes, (ASPECTS,) * len(sizes)),
        rpn_head=InFloat32(RPNHead(channels, len(ASPECTS))),
        rpn_pre_nms_top_n_train=config.candidates,
        rpn_pre_nms_top_n_test=max(1, config.candidates // 2),
        rpn_post_nms_top_n_train=config.proposals,
        rpn_post_nms_top_n_test=max(1, config.proposals // 2),
        rpn_batch_size_per_image=config.anchors_per_image,
        box_roi_pool=MultiScaleRoIAlign(LEVELS, output_size=7, sampling_ratio=2),
        box_head=TwoMLPHead(channels * 49, config.box_features),
        box_predictor=InFloat32(FastRCNNPredictor(config.box_features, 2)),
        box_batch_size_per_image=config.boxes_per_image,
        keypoint_head=keypoint_head(channels, config.keypoint_widths, config.keypoint_norm),
        keypoint_predictor=KeypointRCNNPredictor(config.keypoint_widths[-1], config.n_keypoints),
    )
    if config.mask:
        network.roi_heads.mask_roi_pool = MultiScaleRoIAlign(LEVELS, output_size=14, sampling_ratio=2)
        network.roi_heads.mask_head = MaskRCNNHeads(channels, config.mask_widths, 1)
        network.roi_heads.mask_predictor = MaskRCNNPredictor(config.mask_widths[-1], config.mask_widths[-1], 2)
    return network.to(memory_format=torch.channels_last)  # type: ignore[call-overload]


def keypoint_head(channels: int, widths: tuple[int, ...], norm: bool) -> nn.Sequential:
    """3 x 3 convolutions over the 14 x 14 features of a box."""
    layers: list[nn.Module] = []
    for width in widths:
        convolution = nn.Conv2d(channels, width, 3, padding=1, bias=not norm)
        nn.init.kaiming_normal_(convolution.weight, mode="fan_out", nonlinearity="relu")
        if convolution.bias is not None:
            nn.init.zeros_(convolution.bias)
        layers += [convolution, *([group_norm(width)] if norm else []), nn.ReLU(inplace=True)]
        channels = width
    return nn.Sequential(*layers)


def _backbone(config: NetworkConfig) -> BackboneWithFPN:
    """ResNet with a feature pyramid, every layer trained, for grey images."""
    norm: Callable[[int], nn.Module] = nn.BatchNorm2d if config.norm == "batch" else group_norm
    make = {18: resnet.resnet18, 34: resnet.resnet34, 50: resnet.resnet50}[config.depth]
    body = make(weights=None, norm_layer=norm, zero_init_residual=True)
    body.conv1 = nn.Conv2d(1, 64, kernel_size=7, stride=2, padding=3, bias=False)
    nn.init.kaiming_normal_(body.conv1.weight, mode="fan_out", nonlinearity="relu")
    last = body.fc.in_features
    return BackboneWithFPN(
        body,
        {f"layer{k + 1}": str(k) for k in range(4)},
        [last // 8, last // 4, last // 2, last],
        config.pyramid_channels,
        LastLevelMaxPool(),
        norm_layer=norm,
    )
