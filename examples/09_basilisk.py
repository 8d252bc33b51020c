"""Who flies me there? A servicer in Basilisk that approaches and circles a target and sees nothing but our images."""

import numpy as np

from proxnav.benchmarks import servicing_flight as basilisk
from proxnav.benchmarks.servicing_loop import filter_of, loop_camera
from proxnav.estimator import PoseEstimator

PATH = basilisk.ServicingPath(far_m=30.0, near_m=24.0, hold_s=10.0, approach_s=60.0)
TARGET = basilisk.ServicedTarget()


def main(seconds: float = 120.0, size: int = 512) -> float:
    """From 30 m to 24 m; `ServicingPath()` and 1800 s are the whole flight, from 100 m to 12 m and once round."""
    flight = basilisk.servicing_flight(PATH, TARGET)
    from Basilisk.architecture import messaging  # pyright: ignore[reportMissingImports]
    from Basilisk.utilities import macros  # pyright: ignore[reportMissingImports]

    from proxnav.live.basilisk import PoseSensor, RelativeNavigation, RenderedCamera, config_payload

    # the camera, where it sits, and what it sees: both craft's states in, an image out
    mounted = config_payload(loop_camera(size), np.array(basilisk.CAMERA_AT), basilisk.Q_BODY_CAM)
    config = messaging.CameraConfigMsg().write(mounted)
    camera = RenderedCamera("space-rider", epoch_utc=basilisk.EPOCH)
    camera.chaserStateInMsg.subscribeTo(flight.chaser.scStateOutMsg)
    camera.targetStateInMsg.subscribeTo(flight.target.scStateOutMsg)

    # image in, pose out; then poses and the chaser's own navigation in, the target's state out
    estimator = PoseEstimator.load("space-rider")
    sensor = PoseSensor(estimator)
    sensor.imageInMsg.subscribeTo(camera.imageOutMsg)
    navigation = RelativeNavigation(sensor, estimator.points_target_m, filter_of(TARGET))
    navigation.chaserTransInMsg.subscribeTo(flight.own.transOutMsg)
    sensor.expected = navigation.expected
    for module in (sensor, navigation):
        module.chaserAttInMsg.subscribeTo(flight.own.attOutMsg)
    for module in (camera, sensor, navigation):
        module.cameraConfigInMsg.subscribeTo(config)

    # Basilisk's pointing and position control hear what we believe
    flight.pointing.scTargetInMsg.subscribeTo(navigation.targetTransOutMsg)
    flight.control.chiefTransInMsg.subscribeTo(navigation.targetTransOutMsg)
    flight.control.hillStateInMsg.subscribeTo(navigation.hillStateOutMsg)
    for task, module, priority in (("camera", camera, 2), ("camera", sensor, 1), ("navigation", navigation, 1)):
        flight.sim.AddModelToTask(task, module, priority)
    flight.sim.InitializeSimulation()
    flight.sim.ConfigureStopTime(macros.sec2nano(4.0))
    flight.sim.ExecuteSimulation()  # until the first poses control waits
    flight.sim.enableTask("control")
    flight.sim.ConfigureStopTime(macros.sec2nano(seconds))
    flight.sim.ExecuteSimulation()

    range_m = float(np.linalg.norm(navigation.hillStateOutMsg.read().r_DC_H))
    print(f"{len(sensor.fixes)} poses of {camera.frames} images, {navigation.status}, {range_m:.2f} m from the target")
    return range_m


if __name__ == "__main__":
    main()
