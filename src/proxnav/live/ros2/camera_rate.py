"""How the camera itself turns, by its IMU."""

from collections import deque
from dataclasses import dataclass, field, replace

import numpy as np

from proxnav.geometry.types import Vector3
from proxnav.live.ros2.twist import MovingPose, TargetTwist

_KEPT_S = 30.0


@dataclass(slots=True)
class CameraRate:
    """Rates of the last half minute, camera axes [rad/s]."""

    _kept: deque[tuple[float, Vector3]] = field(default_factory=deque)

    def take(self, t: float, rate_cam: Vector3) -> None:
        """One reading; those that are not numbers are left out."""
        if not np.isfinite(rate_cam).all():
            return
        if self._kept and t < self._kept[-1][0] - _KEPT_S:
            self._kept.clear()  # the clock began anew
        self._kept.append((t, rate_cam))
        while t - self._kept[0][0] > _KEPT_S:
            self._kept.popleft()

    def mean(self, since: float, until: float) -> Vector3 | None:
        """Mean rate of an interval; None where no reading lies in it."""
        rates = [rate for t, rate in self._kept if since <= t <= until]
        return np.mean(rates, axis=0) if rates else None

    def taken_out(self, twist: TargetTwist, before: MovingPose, now: MovingPose) -> TargetTwist:
        """The twist with respect to axes that do not turn with the camera; as it is where nobody knows its turning."""
        rate = self.mean(before.t, now.t)
        if rate is None:
            return twist
        R_target_cam, t_m = now.T_cam_target.R.T, 0.5 * (before.T_cam_target.t_m + now.T_cam_target.t_m)
        return replace(
            twist,
            linear_mps=twist.linear_mps + R_target_cam @ np.cross(rate, t_m),
            angular_radps=twist.angular_radps + R_target_cam @ rate,
        )
