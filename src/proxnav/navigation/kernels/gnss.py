"""What a relative GNSS receiver measures: the baseline between two antennas, and its rate."""

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.rotations import skew, to_matrix
from proxnav.geometry.relative_motion import POSITION, VELOCITY
from proxnav.navigation.kernels.orbit import ric_turning
from proxnav.navigation.layout import GNSS, X


@kernel
def gnss_model(x, R, n, rate_cam, own, other):
    """(H, prediction) of the baseline [m] and its rate [m/s] in ECI axes, R = R_eci_ric turning with n [rad/s].

    From antenna to antenna: `own` in camera axes from the camera, `other` in target axes from the target's origin; each
    turns about its craft's centre of mass.
    """
    own, other = own - x[X.chaser_centre], other - x[X.target_centre]
    R_ec, R_ct = to_matrix(x[X.q_eci_cam]), to_matrix(x[X.q_cam_target])
    w_c, w_t = rate_cam - x[X.gyro_bias], x[X.rate]
    W = ric_turning(n)
    own_v, other_v = np.cross(w_c, own), R_ct @ np.cross(w_t, other)
    H, h = np.zeros((6, GNSS.chaser_centre.stop)), np.empty(6)
    H_r, H_v = H[POSITION], H[VELOCITY]
    H_r[:, GNSS.position], H_r[:, GNSS.gnss_bias] = R, np.eye(3)
    H_r[:, GNSS.attitude_cam] = -R_ec @ skew(own - R_ct @ other)
    H_r[:, GNSS.attitude] = R_ec @ R_ct @ skew(other)
    H_v[:, GNSS.position], H_v[:, GNSS.velocity] = R @ W, R
    H_v[:, GNSS.attitude_cam] = -R_ec @ skew(own_v - other_v)
    H_v[:, GNSS.attitude] = R_ec @ R_ct @ skew(np.cross(w_t, other))
    H_v[:, GNSS.rate], H_v[:, GNSS.gyro_bias] = R_ec @ R_ct @ skew(other), R_ec @ skew(own)
    H_r[:, GNSS.target_centre], H_r[:, GNSS.chaser_centre] = R_ec @ R_ct, -R_ec
    H_v[:, GNSS.target_centre], H_v[:, GNSS.chaser_centre] = R_ec @ R_ct @ skew(w_t), -R_ec @ skew(w_c)
    h[POSITION] = R @ x[X.position] + R_ec @ (own - R_ct @ other) + x[X.gnss_bias]
    h[VELOCITY] = R @ (x[X.velocity] + W @ x[X.position]) + R_ec @ (own_v - other_v)
    return H, h
