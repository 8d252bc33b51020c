"""`proxnav benchmark`: measured tables beside their references."""

from proxnav.commands.choice import choose

BENCHMARKS = {
    "table1": ("benchmark_table1", "main", "pose errors on the fixed Cycles set, beside the study"),
    "solve": ("benchmark_solve", "main", "keypoints to pose, beside OpenCV and PoseLib"),
    "render": ("benchmark_render", "main", "images per second, ray caster and Cycles"),
    "navigation": ("benchmark_navigation", "main", "the filter's consistency, accuracy, faults and speed"),
}


def main(argv: list[str]) -> None:
    """Entry of `proxnav benchmark`."""
    choose(argv, "benchmark", BENCHMARKS)
