"""`proxnav solve`: keypoints of your own detector to poses.json."""

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from proxnav.cli.options import CalibrationOptions
from proxnav.pose.solve.config import PoseConfig
from proxnav.pose.solve.keypoint_files import PixelOrigin


@dataclass(frozen=True)
class SolveConfig(CalibrationOptions):
    """Solves the pose of every image from its keypoints and writes poses.json (SPEED+ keys, status, covariance)."""

    keypoints: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="KEYPOINTS")]
    """COCO keypoint results: image_id or file_name, keypoints [x, y, score] * n, optional covariances_px2."""
    camera: Path
    """Calibration file of the camera: OpenCV, ROS, Kalibr, MATLAB, npz, SPEED+ or plain numbers."""
    target: str
    """Name of a target, its file, or a .mat, .json or .csv of 3-D points [m] in the order of the keypoints."""
    out: Path = Path("poses.json")
    """File to write, .json or .csv."""
    subset: str = ""
    """Named keypoints of the target that the file holds, such as `six`; all when empty."""
    pixel_origin: PixelOrigin = "corner"
    """Where pixel (0, 0) lies: at the `corner` of the first pixel or at its `centre` (OpenCV, most COCO detectors)."""
    pose: PoseConfig = field(default_factory=PoseConfig)


def run(config: SolveConfig) -> int:
    """Reads, solves, writes, and says how many images gave no pose; the exit status is 3 where none did."""
    from proxnav.cli.progress import progress
    from proxnav.datasets.formats.pose_tables import check_pose_file, write_pose_file
    from proxnav.errors import SUSPECT
    from proxnav.pose.solve.images import check_counts, solve_images
    from proxnav.pose.solve.keypoint_files import read_keypoints
    from proxnav.records.estimates import REASONS
    from proxnav.targets.named_points import target_points

    check_pose_file(config.out)
    camera = config.camera_from(config.camera)
    points_m = target_points(config.target, config.subset)
    keypoints = read_keypoints(config.keypoints, config.pixel_origin)
    named = f"{config.target}, subset '{config.subset}'," if config.subset else config.target
    check_counts(keypoints, points_m, config.keypoints, named)
    with progress("solve", len(keypoints)) as done:
        records = solve_images(keypoints, points_m, camera, config.pose, done)
    write_pose_file(config.out, records)
    statuses = Counter(record.status for record in records)
    poses = statuses.pop("ok", 0)
    print(f"{poses} poses from {len(records)} images in {config.out}")
    for status, count in statuses.most_common():
        print(f"  {count} {status}: {REASONS.get(status, 'no pose')}")
    return 0 if poses or not records else SUSPECT
