"""Prints the CPU time of one exposure by the speed-class camera, for a training crop and for a full frame.

    OMP_NUM_THREADS=1 python tools/sensor_speed.py

Thread time, so that other work on the machine counts less; the least of seven runs after a first that compiles.
"""

import time
from dataclasses import replace

import cv2
import numpy as np

from proxnav.geometry import Camera
from proxnav.records import ExposureSpec, RenderedFrame, SceneSpec, SunSpec, Window
from proxnav.sensor import expose
from proxnav.sensor.presets import SENSORS

CAMERA = Camera(1024, 1024, 1407.0, 1407.0, 512.0, 512.0)
BEHIND, IN_FIELD = (0.0, 0.0, -1.0), (0.1, 0.1, 0.99)


def scene(sensor: str, sun: tuple[float, float, float], omega: float) -> SceneSpec:
    """A target at 10 m; `omega` [rad/s] turns the camera."""
    return SceneSpec(
        index=0,
        target="plate",
        camera=CAMERA,
        q_cam_target=(1.0, 0.0, 0.0, 0.0),
        t_cam_target_m=(0.0, 0.0, 10.0),
        sun=SunSpec(sun),
        sensor=replace(SENSORS[sensor], focus_m=0.0),
        exposure=ExposureSpec(exposure_s=2e-4, omega_cam_radps=(0.0, omega, 0.0)),
    )


def frame(size: int) -> RenderedFrame:
    """Grey noise with a square target over a sixteenth of it."""
    radiance = np.random.default_rng(0).random((size, size, 3), dtype=np.float32) * 20.0
    coverage = np.zeros((size, size), dtype=np.float32)
    coverage[size // 4 : size // 2, size // 4 : size // 2] = 1.0
    depth = np.where(coverage > 0, 10.0, np.inf).astype(np.float32)
    window = Window((1024 - size) // 2, (1024 - size) // 2, size, size)
    return RenderedFrame(window, radiance, depth, np.where(coverage > 0, 0, -1).astype(np.int16), coverage)


def cpu_ms(rendered: RenderedFrame, what: SceneSpec) -> float:
    """Least CPU time of one exposure [ms]."""
    expose(rendered, what)
    times = []
    for _ in range(7):
        start = time.thread_time()
        expose(rendered, what)
        times.append(time.thread_time() - start)
    return 1e3 * min(times)


def main() -> None:
    """One line per case."""
    cv2.setNumThreads(1)
    cases = (
        ("mono", "speed-class", BEHIND, 0.0),
        ("colour", "speed-class-colour", BEHIND, 0.0),
        ("mono, camera turning", "speed-class", BEHIND, 20.0),
        ("mono, Sun in the field", "speed-class", IN_FIELD, 0.0),
    )
    for name, sensor, sun, omega in cases:
        crop, full = (cpu_ms(frame(size), scene(sensor, sun, omega)) for size in (128, 1024))
        print(f"{name:24s} 128 px {crop:6.2f} ms   1024 px {full:6.1f} ms")


if __name__ == "__main__":
    main()
