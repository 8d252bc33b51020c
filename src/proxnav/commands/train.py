"""`proxnav train`: a keypoint detector, rendered on line or from a data set."""

from importlib.util import find_spec

from proxnav.cli.choice import choose
from proxnav.errors import InputError

NETWORKS = {
    "heatmap": ("train_heatmap", "crop", "our crop network, on fresh ray-cast crops"),
    "finder": ("train_heatmap", "finder", "the network that finds the target in the full frame"),
    "export": ("train_export", "main", "trained networks as a model folder that runs without torch"),
    "keypoint-rcnn": ("train_rcnn", "main", "the seed study's Keypoint R-CNN"),
}


def main(argv: list[str]) -> None:
    """Entry of `proxnav train`."""
    if find_spec("torch") is None:
        raise InputError("training needs torch: pip install 'proxnav[train]'")
    choose(argv, "train", NETWORKS)
