"""Latency and losses of the ROS 2 node: images at a rate through DDS on the loopback, answers counted and timed.

python tools/ros2_latency.py --rate-hz 1 --seconds 120
"""

import os
import subprocess
import sys
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
import psutil
import tyro

from proxnav.frames import FrameConfig, FrameJob
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.viewing.replay.mcap_export import camera_info

LOOPBACK = (
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name='lo' multicast='false'/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<Peers><Peer address='localhost'/></Peers></Discovery></Domain></CycloneDDS>"
)


@dataclass(frozen=True)
class Options:
    """What is sent, and for how long."""

    rate_hz: float = 1.0
    seconds: float = 60.0
    size_px: int = 1024
    domain: int = 42
    threads: int = 0


def main(options: Options) -> dict[str, Any]:
    """Sends one image again and again, stamped when it is sent, and prints what came back."""
    os.environ["CYCLONEDDS_URI"] = LOOPBACK
    from proxnav.live.ros2 import messages as ros
    from proxnav.live.ros2.installed import domain
    from proxnav.live.ros2.topics import reader, writer

    scene = draw_scenes(load_mission("observation-10-100m"), 1, 7, options.size_px)[0]
    data = FrameJob("space-rider", FrameConfig("raycast"))()(scene).image.tobytes()
    participant = domain.DomainParticipant(options.domain)
    images = writer(participant, "/camera/image_raw", ros.Image, "reliable")
    infos = writer(participant, "/camera/camera_info", ros.CameraInfo, "reliable")
    poses = reader(participant, "/proxnav/pose", ros.PoseWithCovarianceStamped, "reliable")
    fields: dict[str, Any] = camera_info(scene.camera) | {"roi": ros.RegionOfInterest()}
    info = ros.CameraInfo(ros.Header(ros.Time(), "cam_optical_frame"), **fields)
    command = [sys.executable, "-m", "proxnav.live.ros2", "--domain", str(options.domain)]
    command += ["--threads", str(options.threads), "--oldest-s", "0"]
    found: list[float] = []
    sent = memory_first = memory_last = 0

    def show(side: int) -> None:
        infos.write(info)
        head = ros.Header(ros.Time(*divmod(time.time_ns(), 10**9)), "cam_optical_frame")
        images.write(ros.Image(head, side, side, "mono8", 0, side, data))

    def listen(until: float) -> None:
        while time.monotonic() < until:
            for pose in poses.take(20):
                found.append(time.time() - pose.header.stamp.sec - 1e-9 * pose.header.stamp.nanosec)
            time.sleep(0.002)

    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        try:
            while not found:  # until it is there
                show(options.size_px)
                listen(time.monotonic() + 2.0)
            listen(time.monotonic() + 10.0)
            found.clear()
            memory_first = psutil.Process(process.pid).memory_info().rss
            began = time.monotonic()
            while time.monotonic() < began + options.seconds:
                show(options.size_px)
                sent += 1
                listen(began + sent / options.rate_hz)
            listen(time.monotonic() + 10.0)
            memory_last = psutil.Process(process.pid).memory_info().rss
        finally:
            process.kill()
    ms = 1e3 * np.array(found)
    said = {
        "sent": sent, "answered": len(ms), "median_ms": float(np.median(ms)), "p95_ms": float(np.percentile(ms, 95)),
        "worst_ms": float(ms.max()), "memory_mb": [memory_first / 2**20, memory_last / 2**20],
        "load": os.getloadavg()[0], "cores": os.cpu_count(),
    }  # fmt: skip
    print(said)
    return said


if __name__ == "__main__":
    main(tyro.cli(Options))
