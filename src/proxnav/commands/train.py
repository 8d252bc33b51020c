"""`proxnav train`: a keypoint detector, rendered on line or from a data set."""

import sys
from importlib import import_module

from proxnav.errors import InputError

NETWORKS = {
    "heatmap": ("train_heatmap", "crop", "our crop network, on fresh ray-cast crops"),
    "finder": ("train_heatmap", "finder", "the network that finds the target in the full frame"),
    "keypoint-rcnn": ("train_rcnn", "main", "the seed study's Keypoint R-CNN"),
}


def main(argv: list[str]) -> None:
    """Entry of `proxnav train`: the first word names the network, the rest are its options."""
    if not argv or argv[0] in ("-h", "--help"):
        rows = "\n".join(f"  {name:<14} {job}" for name, (_, _, job) in NETWORKS.items())
        print(f"usage: proxnav train NETWORK [options]\n\n{rows}\n\n'proxnav train NETWORK --help' lists its options.")
        return
    if argv[0] not in NETWORKS:
        raise InputError(f"no network '{argv[0]}'; one of {', '.join(NETWORKS)}")
    try:
        import torch  # noqa: F401
    except ImportError:
        raise InputError("training needs torch: pip install 'proxnav[train]'") from None
    print(f"training {argv[0]}; Ctrl-C saves, the same command goes on", file=sys.stderr)
    module, entry = NETWORKS[argv[0]][:2]
    getattr(import_module(f"proxnav.commands.{module}"), entry)(argv[1:])
