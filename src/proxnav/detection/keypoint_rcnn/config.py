"""The network's dimensions and its two named forms: the study's and the one that a small machine can train."""

from dataclasses import asdict, dataclass
from typing import Any, Literal


@dataclass(frozen=True)
class NetworkConfig:
    """Keypoint R-CNN in numbers; pixels are those of the square that the network sees."""

    n_keypoints: int = 6
    side: int = 800
    """Side of the square input [px], a multiple of 32; images are resampled to it."""
    depth: Literal[18, 34, 50] = 50
    """Layers of the residual backbone."""
    norm: Literal["group", "batch"] = "batch"
    """group: independent of the batch; batch: faster, needs 8 images or more in one pass. Never frozen."""
    pyramid_channels: int = 256
    anchor_sizes: tuple[int, int, int, int, int] = (32, 64, 128, 256, 512)
    """One for each level of the pyramid [px]; each with height : width of 1:2, 1:1 and 2:1."""
    anchors_per_image: int = 256
    """Anchors in the loss of the proposal stage."""
    candidates: int = 2000
    """Proposals taken from each level before suppression, in training; half as many in use."""
    proposals: int = 2000
    """Proposals left after suppression, in training; half as many in use."""
    boxes_per_image: int = 512
    """Proposals in the loss of the box head, a quarter of them on the target."""
    jittered_boxes: int = 0
    """Extra proposals made by jittering the true box: the later heads learn before the proposal stage has."""
    box_features: int = 1024
    """Width of the box head."""
    keypoint_widths: tuple[int, ...] = (512,) * 8
    """Channels of the keypoint head's convolutions."""
    keypoint_norm: bool = False
    """GroupNorm after each of them."""
    keypoint_rois: int = 128
    """Boxes per image in the loss of the keypoint and mask heads."""
    keypoint_labels: Literal["cell", "bilinear"] = "cell"
    """cell: one of 56 x 56, as published; bilinear: shared by the four nearest, so that their mean is the point."""
    mask: bool = False
    """A mask head beside the keypoint head."""
    mask_widths: tuple[int, ...] = (256,) * 4
    box_padding: float = 0.0
    """The box is taught larger than the target by this share on every side: keypoints sit on its rim."""

    def to_json(self) -> dict[str, Any]:
        """As JSON content."""
        return {key: list(value) if isinstance(value, tuple) else value for key, value in asdict(self).items()}

    @staticmethod
    def from_json(content: dict[str, Any]) -> "NetworkConfig":
        """Inverse of `to_json`; keys of other things are passed over."""
        own = {key: value for key, value in content.items() if key in NetworkConfig.__dataclass_fields__}
        values: dict[str, Any] = {key: tuple(v) if isinstance(v, list) else v for key, v in own.items()}
        return NetworkConfig(**values)


STUDY = NetworkConfig()
"""torchvision's dimensions, with batch statistics that are learned instead of frozen."""

STUDY_SMALL = NetworkConfig(
    side=320,
    pyramid_channels=128,
    anchor_sizes=(16, 32, 64, 128, 256),
    anchors_per_image=64,
    candidates=200,
    proposals=64,
    boxes_per_image=32,
    jittered_boxes=4,
    box_features=256,
    keypoint_widths=(256,) * 4,
    keypoint_norm=True,
    keypoint_rois=2,
    keypoint_labels="bilinear",
    mask_widths=(128,) * 2,
    box_padding=0.08,
)
"""The same network, slimmer behind the backbone: under 45 MB in 8 bits, trainable on two cores."""
