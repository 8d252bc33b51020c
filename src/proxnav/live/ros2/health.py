"""What the node says about itself, as diagnostics of ROS."""

import time
from collections import Counter
from dataclasses import dataclass, field

from proxnav.live.frame_intake import FAULTS, FrameIntake
from proxnav.live.ros2 import messages as ros
from proxnav.live.ros2.node_config import NodeConfig

OK, WARN, ERROR, STALE = 0, 1, 2, 3


@dataclass(slots=True)
class Health:
    """Counts since the start."""

    intake: FrameIntake
    superseded: int = 0
    """Images that were left because a newer one had come."""
    uncalibrated: int = 0
    """Images before the first CameraInfo."""
    calibration: str = ""
    """What is wrong with the CameraInfo."""
    statuses: Counter[str] = field(default_factory=Counter)
    """Images by the estimator's status."""
    latency_s: float = 0.0
    """From the stamp to the answer, of the last image."""
    heard: float | None = None
    """When the last image came, by the monotonic clock."""

    def judged(self, status: str, latency_s: float) -> None:
        """An image was answered."""
        self.statuses[status] += 1
        self.latency_s = latency_s


def diagnosis(health: Health, config: NodeConfig) -> ros.DiagnosticStatus:
    """Level, sentence and counts."""
    level, sentence = _verdict(health, config)
    counts = {
        "images used": health.intake.used, "images superseded": health.superseded,
        "images before calibration": health.uncalibrated, "restarts of the source": health.intake.restarts,
        **{f"images {fault}": health.intake.faults[fault] for fault in FAULTS},
        **{f"poses {status}": count for status, count in sorted(health.statuses.items())},
        "latency_ms": round(1e3 * health.latency_s),
    }  # fmt: skip
    values = [ros.KeyValue(name, str(count)) for name, count in counts.items()]
    return ros.DiagnosticStatus(level, "proxnav: pose of the target", sentence, config.target_frame, values)


def _verdict(health: Health, config: NodeConfig) -> tuple[int, str]:
    if health.heard is None:
        return STALE, f"no image yet on {config.image}"
    silent = time.monotonic() - health.heard
    if silent > config.silent_s:
        return STALE, f"no image on {config.image} for {silent:.0f} s"
    if health.calibration:
        return ERROR, health.calibration
    if health.uncalibrated and not health.intake.arrived:
        return WARN, f"images come, but no CameraInfo yet on {config.camera_info}"
    if health.intake.faults.total():
        return WARN, f"{health.intake.summary()}; the last for {health.intake.reason}"
    return OK, health.intake.summary()
