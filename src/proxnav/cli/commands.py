"""The commands of the command line."""

COMMANDS = {
    "demo": "the whole chain, small: render, estimate, solve, evaluate, plot",
    "render": "a data set or a sequence, from a preset or a trajectory file",
    "train": "a keypoint detector, from a data set or rendered on line",
    "estimate": "images or a data set to poses.json",
    "solve": "keypoints of your own detector to poses.json",
    "simulate": "sensor records along a trajectory: camera, gyro, star tracker, GNSS",
    "navigate": "the filter over records: navigation solution with covariance",
    "evaluate": "poses.json against truth: the study's Table 1 and ours",
    "report": "one HTML page of a finished run",
    "view": "replay of a run: Rerun, video (.mp4) or MCAP",
    "target": "look at a target: keypoints, extents, preview",
    "convert": "data sets, poses and trajectories between formats",
    "benchmark": "measured tables beside their references",
    "completion": "script that completes commands and options in bash, zsh or fish",
    "setup": "install what proxnav cannot bring itself: blender",
}
"""Name and job of every command, in the order of the flow."""
