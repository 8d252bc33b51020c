"""`proxnav benchmark`: measured tables beside their references."""

from proxnav.cli.choice import choose

BENCHMARKS = {
    "table1": ("benchmark_table1", "main", "pose errors on the fixed Cycles set, beside the study"),
    "solve": ("benchmark_solve", "main", "keypoints to pose, beside OpenCV and PoseLib"),
    "latency": ("benchmark_latency", "main", "image to pose and covariance, beside torchvision's Keypoint R-CNN"),
    "conditions": ("benchmark_conditions", "main", "the same errors in worse light, noise, blur, and without a target"),
    "render": ("benchmark_render", "main", "images per second, ray caster and Cycles"),
    "detector": ("benchmark_detector", "main", "how long the detector's errors last along the spiral"),
    "scale": ("benchmark_scale", "main", "frames per second over workers, by processes and by Ray"),
    "navigation": ("benchmark_navigation", "main", "the filter's consistency, accuracy, faults and speed"),
}


def main(argv: list[str]) -> None:
    """Entry of `proxnav benchmark`."""
    choose(argv, "benchmark", BENCHMARKS)
