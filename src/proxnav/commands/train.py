"""`proxnav train`: a keypoint detector, rendered on line or from a data set."""

import sys

from proxnav.errors import InputError

NETWORKS = {
    "heatmap": "our crop network, on fresh ray-cast crops",
    "finder": "the network that finds the target in the full frame",
    "keypoint-rcnn": "the seed study's Keypoint R-CNN",
}


def main(argv: list[str]) -> None:
    """Entry of `proxnav train`: the first word names the network, the rest are its options."""
    if not argv or argv[0] in ("-h", "--help"):
        rows = "\n".join(f"  {name:<14} {job}" for name, job in NETWORKS.items())
        print(f"usage: proxnav train NETWORK [options]\n\n{rows}\n\n'proxnav train NETWORK --help' lists its options.")
        return
    if argv[0] not in NETWORKS:
        raise InputError(f"no network '{argv[0]}'; one of {', '.join(NETWORKS)}")
    try:
        import torch  # noqa: F401
    except ImportError:
        raise InputError("training needs torch: pip install 'proxnav[train]'") from None
    from proxnav.commands import train_heatmap, train_rcnn

    runs = {"heatmap": train_heatmap.crop, "finder": train_heatmap.finder, "keypoint-rcnn": train_rcnn.main}
    print(f"training {argv[0]}; Ctrl-C saves, the same command goes on", file=sys.stderr)
    runs[argv[0]](argv[1:])
