"""Plain scenes for the sensor: a uniform field, with or without a square target."""

from collections.abc import Callable

import numpy as np
import pytest

from proxnav.geometry import Camera
from proxnav.records import ExposureSpec, RenderedFrame, SceneSpec, SensorSpec, SunSpec, Window

CAMERA = Camera(width=256, height=192, fx=300.0, fy=300.0, cx=128.0, cy=96.0)


@pytest.fixture
def make_frame() -> Callable[..., RenderedFrame]:
    """Frame of a radiance image (h, w) or (h, w, 3), optionally with coverage and depth, at a window's corner."""

    def make(
        radiance: np.ndarray, coverage: np.ndarray | None = None, depth_m: float = 10.0, corner=(0, 0)
    ) -> RenderedFrame:
        radiance = np.asarray(radiance, dtype=np.float32)
        if radiance.ndim == 2:
            radiance = np.repeat(radiance[..., None] / 3.0, 3, axis=2)
        height, width = radiance.shape[:2]
        cover = np.zeros((height, width)) if coverage is None else coverage
        seen = cover >= 0.5
        depth = np.where(seen, depth_m, np.inf).astype(np.float32)
        window = Window(corner[0], corner[1], width, height)
        return RenderedFrame(window, radiance, depth, np.where(seen, 0, -1).astype(np.int16), cover.astype(np.float32))

    return make


@pytest.fixture
def make_scene() -> Callable[..., SceneSpec]:
    """Scene with a sensor, an exposure and the Sun behind the camera unless said otherwise."""

    def make(
        sensor: SensorSpec,
        exposure: ExposureSpec | None = None,
        sun: SunSpec | None = None,
        camera: Camera = CAMERA,
    ) -> SceneSpec:
        return SceneSpec(
            index=0,
            target="plate",
            camera=camera,
            q_cam_target=(1.0, 0.0, 0.0, 0.0),
            t_cam_target_m=(0.0, 0.0, 10.0),
            sun=sun or SunSpec(direction_target=(0.0, 0.0, -1.0)),
            sensor=sensor,
            exposure=exposure or ExposureSpec(exposure_s=1e-3),
        )

    return make
