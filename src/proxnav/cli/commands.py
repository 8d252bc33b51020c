"""The commands of the command line: what each does and which module of `proxnav.commands` it is.

Its function `run` takes one frozen dataclass, whose fields are the command's options, and prints what came out.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Command:
    """One command and where it lives."""

    job: str
    """What it does, in a line."""
    module: str
    """Module of `proxnav.commands`."""
    renamed: Mapping[str, str] = field(default_factory=dict)
    """Former spelling of an option to the present one."""


@dataclass(frozen=True, slots=True)
class Group:
    """Commands that share their first word: `proxnav train heatmap`."""

    job: str
    commands: Mapping[str, Command]


TRAIN = {
    "heatmap": Command("our crop network, on fresh ray-cast crops", "train_heatmap"),
    "finder": Command("the network that finds the target in the full frame", "train_finder"),
    "export": Command("trained networks as a model folder that runs without torch", "train_export"),
    "trust": Command("when a model's poses are to be believed, from frames whose truth is known", "train_trust"),
    "keypoint-rcnn": Command("the seed study's Keypoint R-CNN", "train_rcnn", renamed={"--preset": "--recipe"}),
}
MISSION = {
    "show": Command("frames of a mission, and the accuracy, light and motion it allows", "mission_show"),
    "new": Command("a commented mission file, from options or by asking", "mission_new"),
}
TARGET = {
    "show": Command("size, parts, keypoints and the accuracy they allow; a picture from eight sides", "target_show"),
    "new": Command("a target from a mesh file: scale, axes, keypoints, preview", "target_new"),
}
BENCHMARK = {
    "table1": Command("pose errors on the fixed Cycles set, beside the study", "benchmark_table1"),
    "solve": Command("keypoints to pose, beside OpenCV and PoseLib", "benchmark_solve"),
    "latency": Command("image to pose and covariance, beside torchvision's Keypoint R-CNN", "benchmark_latency"),
    "conditions": Command("pose errors in worse light, noise, blur, and without a target", "benchmark_conditions"),
    "render": Command("images per second, ray caster and Cycles", "benchmark_render"),
    "detector": Command("how long the detector's errors last along the spiral", "benchmark_detector"),
    "scale": Command("frames per second over workers, by processes and by Ray", "benchmark_scale"),
    "speedplus": Command("poses on SPEED+ images, with the scores of its challenges", "benchmark_speedplus"),
    "trust": Command("how often a model is confidently wrong, and what catches it", "benchmark_trust"),
    "track": Command("the tracker without a network: skipped frames, starts that are off", "benchmark_track"),
    "navigation": Command("the filter's consistency, accuracy, faults and speed", "benchmark_navigation"),
}

COMMANDS: dict[str, Command | Group] = {
    "demo": Command("the whole chain, small: render, estimate, solve, evaluate, plot", "demo"),
    "learn": Command("a model of your mission: train, calibrate, measure, report", "learn"),
    "render": Command("a data set or a sequence, from a preset or a trajectory file", "render"),
    "train": Group("a keypoint detector, from a data set or rendered on line", TRAIN),
    "estimate": Command("images or a data set to poses.json", "estimate"),
    "track": Command("follow a CAD model through a sequence, without a network", "track"),
    "solve": Command("keypoints of your own detector to poses.json", "solve"),
    "simulate": Command(
        "sensor records along a trajectory: camera, gyro, star tracker, GNSS",
        "simulate",
        renamed={"--camera": "--detector modelled (was model) or --detector raycast"},
    ),
    "navigate": Command("the filter over records: navigation solution with covariance", "navigate"),
    "live": Command("poses of images as they come: a folder that fills, a video, a camera", "live"),
    "evaluate": Command("poses.json against truth: the study's Table 1 and ours", "evaluate"),
    "report": Command("one HTML page of a finished run", "report"),
    "view": Command("replay of a run: Rerun, video (.mp4) or MCAP", "view"),
    "mission": Group("say once what is looked at, by which camera and from where", MISSION),
    "target": Group("look at a target: keypoints, extents, preview", TARGET),
    "convert": Command(
        "data sets, poses and trajectories between formats",
        "convert",
        renamed={"--flight": "--reader"},
    ),
    "benchmark": Group("measured tables beside their references", BENCHMARK),
    "completion": Command("script that completes commands and options in bash, zsh or fish", "completion"),
    "setup": Command("install what proxnav cannot bring itself: blender", "setup"),
}
"""Every command, in the order of the flow."""


def every_command() -> dict[str, Command]:
    """All commands by what is typed: 'render', 'train heatmap'."""
    found: dict[str, Command] = {}
    for name, entry in COMMANDS.items():
        if isinstance(entry, Group):
            found |= {f"{name} {word}": command for word, command in entry.commands.items()}
        else:
            found[name] = entry
    return found
