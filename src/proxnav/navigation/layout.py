"""Where each quantity lies in the filter's state vector x and in its error vector.

x:     r 0-3, v 3-6, q_eci_cam 6-10, q_cam_target 10-14, rate 14-17, gyro bias 17-20, acceleration 20-23, GNSS bias
       23-26, camera errors from 26
error: r 0-3, v 3-6, camera attitude 6-9, relative attitude 9-12, rate 12-15, gyro bias 15-18, acceleration 18-21, GNSS
       bias 21-24, camera errors from 24

r, v: camera relative to the target's origin, RIC axes, rates in the rotating frame. Attitude errors are local:
q_true = q * exp(error / 2), in camera axes for q_eci_cam and in target axes for q_cam_target. The camera errors are,
with tight coupling, two of each keypoint in units of their own standard deviation; then always six of the whole pose:
dt [m] in camera axes and dr [rad] in target axes, by which the camera sees the target displaced.
"""

CORE = 21
"""Errors with dynamics of their own; the rest only decay."""
FIXED = 24
"""Errors without the camera's."""
X_FIXED = 26

PUBLISHED = (0, 1, 2, 3, 4, 5, 9, 10, 11, 12, 13, 14)
"""Errors that the navigation solution gives: position, velocity, relative attitude, target rate."""
