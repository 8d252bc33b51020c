"""What the navigation solution gives: motion of the camera about the target's origin, not of the centres of mass."""

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.rotations import exp, skew, to_matrix
from proxnav.geometry.perturbation import ROTATION
from proxnav.navigation.kernels.blocks import set_diagonal
from proxnav.navigation.kernels.orbit import ric_turning
from proxnav.navigation.kernels.seen_pose import seen_pose, true_pose
from proxnav.navigation.layout import FRAME, N_FIXED, N_POSE, E, X
from proxnav.records.navigation import NAV_ERRORS

_N = NAV_ERRORS.rate.stop


@kernel
def published(x, R_eci_ric, n, rate_cam):
    """(position [m], velocity [m/s], J) of the camera relative to the target's origin, RIC axes.

    J: derivatives of the errors of `NAV_ERRORS` by those of every filter.
    """
    R_ec, R_ct, W = to_matrix(x[X.q_eci_cam]), to_matrix(x[X.q_cam_target]), ric_turning(n)
    R_rc = R_eci_ric.T @ R_ec
    R_rt = R_rc @ R_ct
    w_c, w_t, own, other = rate_cam - x[X.gyro_bias], x[X.rate], x[X.chaser_centre], x[X.target_centre]
    arm, arm_v = R_ct @ other - own, R_ct @ np.cross(w_t, other) - np.cross(w_c, own)
    out = R_rc @ arm
    J = np.zeros((_N, N_FIXED))
    J_r, J_v, J_q = J[NAV_ERRORS.position], J[NAV_ERRORS.velocity], J[NAV_ERRORS.attitude]
    set_diagonal(J, NAV_ERRORS.position, E.position, 1.0)
    J_r[:, E.attitude_cam], J_r[:, E.attitude] = -R_rc @ skew(arm), -R_rt @ skew(other)
    J_r[:, E.target_centre], J_r[:, E.chaser_centre] = R_rt, -R_rc
    set_diagonal(J, NAV_ERRORS.velocity, E.velocity, 1.0)
    J_v[:, E.attitude_cam] = -R_rc @ skew(arm_v) + W @ R_rc @ skew(arm)
    J_v[:, E.attitude] = -R_rt @ skew(np.cross(w_t, other)) + W @ R_rt @ skew(other)
    J_v[:, E.rate], J_v[:, E.gyro_bias] = -R_rt @ skew(other), -R_rc @ skew(own)
    J_v[:, E.target_centre], J_v[:, E.chaser_centre] = R_rt @ skew(w_t) - W @ R_rt, -R_rc @ skew(w_c) + W @ R_rc
    set_diagonal(J, NAV_ERRORS.attitude, E.attitude, 1.0)
    J_q[:, E.misalignment] = -(to_matrix(exp(-x[X.misalignment])) @ R_ct).T
    set_diagonal(J, NAV_ERRORS.rate, E.rate, 1.0)
    return x[X.position] + out, x[X.velocity] + R_rc @ arm_v - W @ out, J


@kernel
def pose_errors(x, R_eci_ric):
    """Derivatives of (dt [m], dr [rad]) of T_cam_target in the camera's real axes by the errors of every filter."""
    H, _, _ = seen_pose(x, R_eci_ric, 0.0, np.zeros(3))
    _, R_cam_target = true_pose(x, R_eci_ric)
    G = np.zeros((N_POSE, N_FIXED))
    G[:, E.position], G[:, E.attitudes] = H[:, FRAME.position], H[:, FRAME.attitudes]
    G[:, E.geometry] = H[:, FRAME.geometry]
    G[:, E.clock] = 0.0
    G[ROTATION] = R_cam_target @ np.ascontiguousarray(G[ROTATION])
    return G
