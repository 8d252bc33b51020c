"""The training losses of Keypoint R-CNN, out of torchvision's parts."""

from collections import OrderedDict
from typing import Any

import torch
from torch import Tensor
from torchvision.models.detection import KeypointRCNN
from torchvision.models.detection.image_list import ImageList
from torchvision.models.detection.roi_heads import fastrcnn_loss, maskrcnn_loss

from proxnav.detection.keypoint_rcnn.config import NetworkConfig

JITTER = 0.12
"""Standard deviation of a jittered box's centre and log size, in box sizes."""


def training_losses(
    network: KeypointRCNN,
    config: NetworkConfig,
    images: ImageList,
    features: OrderedDict[str, Tensor],
    batch: dict[str, Any],
) -> dict[str, Tensor]:
    """Terms of the proposal stage, of the box head, of the keypoint head and, where there is one, of the mask head."""
    heads: Any = network.roi_heads
    targets = _targets(batch)
    proposals, losses = network.rpn(images, features, targets)
    extra = [jittered(target["boxes"], config.jittered_boxes) for target in targets]
    proposals = [torch.cat(pair) for pair in zip(proposals, extra, strict=True)]
    proposals, _, labels, regression = heads.select_training_samples(proposals, targets)
    pooled = heads.box_head(heads.box_roi_pool(features, proposals, images.image_sizes))
    logits, deltas = heads.box_predictor(pooled)
    losses["classifier"], losses["box"] = fastrcnn_loss(logits, deltas, labels, regression)

    rois, owner, labelled = _boxes_on_target(proposals, labels, batch["labelled"], config.keypoint_rois)
    pooled = heads.keypoint_roi_pool(features, rois, images.image_sizes)
    maps = heads.keypoint_predictor(heads.keypoint_head(pooled)).float()
    keypoints = batch["keypoints"][owner]
    losses["keypoint"] = keypoint_loss(maps, torch.cat(rois), keypoints, labelled, config.keypoint_labels)
    if config.mask:
        pooled = heads.mask_roi_pool(features, rois, images.image_sizes)
        logits = heads.mask_predictor(heads.mask_head(pooled)).float()
        losses["mask"] = _mask_loss(logits, rois, batch)
    return losses


def _boxes_on_target(
    proposals: list[Tensor], labels: list[Tensor], labelled: Tensor, most: int
) -> tuple[list[Tensor], Tensor, Tensor]:
    """Up to `most` boxes of each image that lie on its target, the image of each, and which keypoints it may teach."""
    device = labelled.device
    rois = [_some(boxes[on > 0], most) for boxes, on in zip(proposals, labels, strict=True)]
    owner = torch.cat([torch.full((len(boxes),), index, device=device) for index, boxes in enumerate(rois)])
    if len(owner):
        return rois, owner, labelled[owner]
    # No target in the whole batch: one box that teaches nothing keeps every parameter in the graph.
    rois[0], owner = proposals[0][:1], torch.zeros(1, dtype=torch.int64, device=device)
    return rois, owner, torch.zeros_like(labelled[owner])


def keypoint_loss(maps: Tensor, rois: Tensor, keypoints: Tensor, labelled: Tensor, labels: str) -> Tensor:
    """Mean cross entropy of the maps (r, n, s, s) of boxes `rois` (r, 4) against keypoints (r, n, 2) inside them."""
    side = maps.shape[-1]
    cells = (keypoints - rois[:, None, :2]) * (side / (rois[:, None, 2:] - rois[:, None, :2]).clamp(min=1e-3))
    inside = labelled & ((cells >= 0) & (cells < side)).all(-1)
    log_p = maps.flatten(2).log_softmax(-1)
    spread = cell_weights if labels == "cell" else bilinear_weights
    index, weight = spread(torch.where(inside[..., None], cells, 0.0), side)
    terms = -(log_p.gather(2, index) * weight).sum(-1)
    return (terms * inside).sum() / inside.sum().clamp(min=1)


def cell_weights(cells: Tensor, side: int) -> tuple[Tensor, Tensor]:
    """The one cell that holds the point, by flat index: (r, n, 1) each."""
    corner = cells.floor().long().clamp(0, side - 1)
    return (corner[..., 1] * side + corner[..., 0])[..., None], torch.ones_like(cells[..., :1])


def bilinear_weights(cells: Tensor, side: int) -> tuple[Tensor, Tensor]:
    """The four cells whose centres surround the point, weighted so that their mean is the point: (r, n, 4) each."""
    low = (cells - 0.5).floor()
    share = cells - 0.5 - low
    index, weight = [], []
    for dy in (0, 1):
        for dx in (0, 1):
            step = torch.tensor([dx, dy], device=cells.device)
            at = (low.long() + step).clamp(0, side - 1)
            w = torch.where(step.bool(), share, 1.0 - share)
            index.append(at[..., 1] * side + at[..., 0])
            weight.append(w[..., 0] * w[..., 1])
    return torch.stack(index, -1), torch.stack(weight, -1)


def jittered(boxes: Tensor, n: int) -> Tensor:
    """`n` copies of each box, moved and scaled at random."""
    if n == 0 or len(boxes) == 0:
        return boxes[:0]
    centre = (boxes[:, :2] + boxes[:, 2:]) / 2
    size = boxes[:, 2:] - boxes[:, :2]
    noise = JITTER * torch.randn(n, len(boxes), 2, 2, device=boxes.device)
    centre = centre + noise[:, :, 0] * size
    half = size * noise[:, :, 1].exp() / 2
    return torch.cat((centre - half, centre + half), -1).reshape(-1, 4)


def _targets(batch: dict[str, Any]) -> list[dict[str, Tensor]]:
    """Labels as torchvision wants them: an image without target has no boxes."""
    targets = []
    for box, has_target in zip(batch["boxes"], batch["has_target"].tolist(), strict=True):
        boxes = box[None] if has_target else box[None][:0]
        targets.append({"boxes": boxes, "labels": torch.ones(len(boxes), dtype=torch.int64, device=box.device)})
    if "masks" in batch:
        for target, mask in zip(targets, batch["masks"], strict=True):
            target["masks"] = mask[None][: len(target["boxes"])]
    return targets


def _some(boxes: Tensor, most: int) -> Tensor:
    """At most `most` of the boxes, chosen at random."""
    return boxes[torch.randperm(len(boxes), device=boxes.device)[:most]]


def _mask_loss(logits: Tensor, rois: list[Tensor], batch: dict[str, Any]) -> Tensor:
    if not batch["has_target"].any():
        return logits.sum() * 0.0
    one = torch.ones(1, dtype=torch.int64, device=logits.device)
    matched = [torch.zeros(len(boxes), dtype=torch.int64, device=logits.device) for boxes in rois]
    return maskrcnn_loss(logits, rois, [mask[None] for mask in batch["masks"]], [one] * len(rois), matched)
